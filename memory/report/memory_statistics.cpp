#include "memory/report/memory_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/natural_order.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/time_parser.h"
#include "memory/store/store.h"

namespace loci::memory {
namespace {

constexpr int kHours = 24;
constexpr int kConfidenceBins = 10;
constexpr double kFlat_m = 0.03;  ///< observations up to this height are flat: plates, books, cutlery
constexpr int64_t kPointsPerBin = 1000, kPointBins = 13;

/// The number of scenes by their number of observations, from none to the most.
std::vector<std::pair<std::string, double>> per_scene(const std::map<int, double>& scenes) {
  std::vector<std::pair<std::string, double>> bars;
  const int most = scenes.empty() ? -1 : scenes.rbegin()->first;
  for (int count = 0; count <= most; ++count)
    bars.emplace_back(fmt::format("{}", count), scenes.contains(count) ? scenes.at(count) : 0);
  return bars;
}

/// Counts over scenes.
class Counter {
 public:
  explicit Counter(const Store& store) : store_(store), zone_(store.time_zone()) {
    for (const PlaceRow& place : named_places(store)) places_[place.id] = place.name;
  }

  void add(const SceneRow& scene) {
    const auto hour = static_cast<size_t>(local_hour(scene.time, zone_));
    std::map<Id, std::optional<Id>> place_of;
    int flat = 0, high = 0;
    for (const ObservationRow& observation : store_.observations(scene.id)) {
      ++observations_;
      place_of[observation.id] = observation.place;
      if (observation.size) ++(observation.size->z() <= kFlat_m ? flat : high);
      if (observation.points)
        ++points_[static_cast<size_t>(
            std::clamp<int64_t>((*observation.points - 1) / kPointsPerBin, 0, kPointBins - 1))];
    }
    ++flat_[flat];
    ++high_[high];
    ++all_[static_cast<int>(place_of.size())];
    for (const AnnotationRow& annotation : store_.annotations(scene.id)) ++annotations_[annotation.type];
    for (const AssociationRow& association : store_.associations(scene.id)) {
      if (!association.chosen || !association.observation || !association.object) continue;
      by_hour_[hour].insert(*association.object);
      const int bin = static_cast<int>(association.probability * kConfidenceBins);
      ++confidence_[static_cast<size_t>(std::clamp(bin, 0, kConfidenceBins - 1))];
      const auto place = place_of.find(*association.observation);
      if (place != place_of.end() && place->second)
        by_place_[places_[*place->second]].insert(*association.object);
    }
  }

  std::vector<Chart> charts() const {
    Chart types{"Observations and annotations by type", "rows", {{"observation", observations_}}};
    for (const auto& [type, count] : annotations_) types.bars.emplace_back(type, count);
    Chart hours{"Objects by hour of the day", "different objects", {}};
    for (size_t hour = 0; hour < kHours; ++hour)
      hours.bars.emplace_back(fmt::format("{:02}", hour), by_hour_[hour].size());
    Chart places{"Objects by place", "different objects", {}};
    for (const auto& [place, objects] : by_place_) places.bars.emplace_back(place, objects.size());
    Chart sure{"Probabilities of associations", "observations", {}};
    for (size_t bin = 0; bin < kConfidenceBins; ++bin)
      sure.bars.emplace_back(fmt::format("{}–{} %", bin * 10, bin * 10 + 10), confidence_[bin]);
    return {types,
            {"Observations per scene", "scenes", per_scene(all_)},
            {fmt::format("Flat observations per scene (up to {:.0f} cm high)", 100 * kFlat_m), "scenes",
             per_scene(flat_)},
            {"Higher observations per scene", "scenes", per_scene(high_)},
            sizes(),
            hours,
            places,
            sure};
  }

 private:
  Chart sizes() const {
    Chart chart{"Sizes of observations in points", "observations", {}};
    for (int64_t bin = 0; bin < kPointBins; ++bin)
      chart.bars.emplace_back(bin + 1 < kPointBins ? fmt::format("≤ {}", (bin + 1) * kPointsPerBin)
                                                   : fmt::format("> {}", bin * kPointsPerBin),
                              points_[static_cast<size_t>(bin)]);
    return chart;
  }

  const Store& store_;
  TimeZone zone_;
  std::map<Id, std::string> places_;
  double observations_ = 0;
  std::map<std::string, double> annotations_;
  std::map<int, double> flat_, high_, all_;  ///< scenes, by their number of observations
  std::array<double, kPointBins> points_ = {};
  std::array<std::set<Id>, kHours> by_hour_;
  std::map<std::string, std::set<Id>, NaturalOrder> by_place_;
  std::array<double, kConfidenceBins> confidence_ = {};
};

}  // namespace

std::vector<Chart> memory_statistics(const Store& store, Progress& progress) {
  const auto scenes = store.scenes();
  Counter counter(store);
  for (size_t i = 0; i < scenes.size(); ++i) {
    progress.check(static_cast<double>(i) / static_cast<double>(scenes.size()), "counting");
    counter.add(scenes[i]);
  }
  std::vector<Chart> charts = counter.charts();
  Chart times{"Time per annotator", "ms per scene", {}};
  for (const AnnotatorTimes& annotator : annotator_times(store.path()))
    times.bars.emplace_back(annotator.name, std::round(annotator.ms_per_scene() * 100) / 100);
  if (!times.bars.empty()) charts.push_back(std::move(times));
  return charts;
}

std::string statistics_csv(const std::vector<Chart>& charts) {
  std::string csv = "chart,name,value\n";
  for (const Chart& chart : charts)
    for (const auto& [name, value] : chart.bars)
      csv += fmt::format("{},{},{}\n", csv_cell(chart.title), csv_cell(name), value);
  return csv;
}

std::vector<AnnotatorTimes> annotator_times(const std::filesystem::path& memory) {
  std::filesystem::path path = memory;
  path.replace_extension(".statistics.json");
  std::vector<AnnotatorTimes> all;
  if (!std::filesystem::exists(path)) return all;
  const Json annotators = read_json(path).value("annotators", Json::object());
  for (const auto& [name, row] : annotators.items()) {
    const auto count = [&row = row](const char* key) { return row.value(key, int64_t{0}); };
    all.push_back({name, count("scenes"), row.value("seconds", 0.0), count("failures"), count("timeouts"),
                   count("retries")});
  }
  std::stable_sort(all.begin(), all.end(), [](const AnnotatorTimes& a, const AnnotatorTimes& b) {
    return a.ms_per_scene() > b.ms_per_scene();
  });
  return all;
}

}  // namespace loci::memory
