#include "memory/report/report_data.h"
#include "memory/questions/objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace loci::memory {
namespace {

/// Those with most observations, in order of id.
std::vector<ObjectBelief> seen_most(std::vector<ObjectBelief> objects, size_t most) {
  std::stable_sort(objects.begin(), objects.end(),
                   [](const ObjectBelief& a, const ObjectBelief& b) { return a.sightings > b.sightings; });
  if (objects.size() > most) objects.resize(most);
  std::sort(objects.begin(), objects.end(),
            [](const ObjectBelief& a, const ObjectBelief& b) { return a.object.id < b.object.id; });
  return objects;
}

}  // namespace

ReportData::ReportData(const Store& memory, const ReportOptions& options, Progress& progress)
    : store(memory), times(memory) {
  std::vector<ObjectBelief> all = ask(store, ObjectsQuestion{}).objects;
  objects = all.size();
  const std::vector<ObjectBelief> chosen = seen_most(std::move(all), options.objects);
  for (size_t i = 0; i < chosen.size(); ++i) {
    progress.check(static_cast<double>(i) / static_cast<double>(chosen.size()), "reading histories");
    HistoryAnswer answer = ask(store, HistoryQuestion{.subject = chosen[i].object.name});
    for (ObjectHistory& history : answer.objects) histories.push_back(std::move(history));
  }
  scenes = store.scenes();
  scenes_in_all = scenes.size();
  if (scenes.size() > options.scenes)
    scenes.erase(scenes.begin(), scenes.end() - static_cast<std::ptrdiff_t>(options.scenes));
}

std::string ReportData::objects_left_out() const {
  if (histories.size() >= objects) return "";
  return fmt::format("<p class=\"faint\">Of {} objects the {} with most observations.</p>\n", objects,
                     histories.size());
}

std::string ReportData::scenes_left_out() const {
  if (scenes.size() >= scenes_in_all) return "";
  return fmt::format("<p class=\"faint\">Of {} scenes the last {}.</p>\n", scenes_in_all, scenes.size());
}

std::string partner_name(const std::optional<Id>& object) {
  return object ? object_name(*object) : "clutter";
}

std::map<Id, ChosenAssociation> chosen_associations(const Store& store, Id scene) {
  const std::vector<AssociationRow> considered = store.associations(scene);
  std::map<Id, ChosenAssociation> result;
  for (const AssociationRow& row : considered)
    if (row.chosen && row.observation) result[*row.observation].chosen = row;
  std::map<Id, std::map<std::optional<Id>, double>> others;
  for (const AssociationRow& row : considered) {
    if (!row.observation || !result.contains(*row.observation)) continue;
    ChosenAssociation& association = result.at(*row.observation);
    if (row.object == association.chosen.object)
      association.probability += row.probability;
    else
      others[*row.observation][row.object] += row.probability;
  }
  for (const auto& [observation, objects] : others)
    for (const auto& [object, probability] : objects)
      if (std::string& text = result.at(observation).alternatives; probability >= 0.01)
        text +=
            fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", partner_name(object), 100 * probability);
  return result;
}

std::string object_css(Id object) {
  constexpr double kGoldenAngle = 137.508;                 // neighbours in number are far apart in hue
  constexpr std::array<int, 3> kLightness = {45, 32, 58};  // greens of like hue differ in lightness
  return fmt::format("hsl({:.0f} 65% {}%)", std::fmod(static_cast<double>(object) * kGoldenAngle, 360),
                     kLightness[static_cast<size_t>(object) % kLightness.size()]);
}

}  // namespace loci::memory
