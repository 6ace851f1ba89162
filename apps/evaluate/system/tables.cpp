#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "apps/evaluate/system/experiment.h"
#include "mapping/base/text/json.h"

namespace loci::apps::system_evaluation {
namespace {

constexpr size_t kBin = 1000;  ///< points, of table 8.4
constexpr size_t kBins = 13;   ///< the last is open
constexpr size_t kMax = 25;    ///< lines of table 8.6

double share(size_t part, size_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

int of(const Histogram& histogram, int value) {
  const auto found = histogram.find(value);
  return found == histogram.end() ? 0 : found->second;
}

std::string counts_table(const char* title, const Histogram& published, const Histogram& set,
                         const Histogram& found) {
  std::set<int> values;
  for (const Histogram* histogram : {&published, &set, &found})
    for (const auto& entry : *histogram) values.insert(entry.first);
  std::string text =
      fmt::format("{}\n  {:>8}{:>12}{:>12}{:>12}\n", title, "number", "dissertation", "set up", "found");
  for (const int value : values)
    text += fmt::format("  {:>8}{:>12}{:>12}{:>12}\n", value, of(published, value), of(set, value),
                        of(found, value));
  return text + "\n";
}

std::vector<size_t> size_bins(const std::vector<size_t>& points) {
  std::vector<size_t> bins(kBins, 0);
  for (const size_t count : points) ++bins[std::min(kBins - 1, count == 0 ? 0 : (count - 1) / kBin)];
  return bins;
}

double mean(const std::vector<size_t>& values) {
  return values.empty() ? 0
                        : static_cast<double>(std::accumulate(values.begin(), values.end(), size_t{0})) /
                              static_cast<double>(values.size());
}

std::string sizes_table(const std::vector<size_t>& points) {
  constexpr size_t kPublished[kBins] = {145, 98, 127, 71, 42, 29, 15, 13, 15, 9, 8, 7, 8};
  const std::vector<size_t> bins = size_bins(points);
  std::string text =
      fmt::format("Table 8.4: points of a cluster (mean {:.0f}; dissertation 3083)\n  {:>18}{:>12}{:>8}\n",
                  mean(points), "", "dissertation", "run");
  for (size_t i = 0; i < kBins; ++i)
    text += fmt::format("  {:>18}{:>12}{:>8}\n",
                        i + 1 == kBins ? fmt::format("> {}", i * kBin)
                                       : fmt::format("{} to {}", i * kBin + (i > 0 ? 1 : 0), (i + 1) * kBin),
                        kPublished[i], bins[i]);
  return text + "\n";
}

std::string types_table(const std::vector<TypeCount>& types) {
  std::string text;
  for (const TypeCount& type : types) text += fmt::format("  {:<34}{:>8}\n", type.type, type.count);
  return text;
}

/// Table 8.5: what is on every scene, on every cluster, and on some.
std::string annotations_table(const SystemResult& result) {
  std::string text = "Table 8.5: annotations\n on scenes\n" + types_table(result.scene_types);
  std::vector<TypeCount> every, some;
  for (const TypeCount& type : result.cluster_types)
    (type.count == result.clusters ? every : some).push_back(type);
  return text + " on every cluster\n" + types_table(every) + " on some clusters\n" + types_table(some) + "\n";
}

std::vector<std::pair<size_t, std::pair<std::string, std::string>>> most_frequent(
    const SystemResult& result) {
  std::vector<std::pair<size_t, std::pair<std::string, std::string>>> list;
  for (const auto& [what, count] : result.results) list.emplace_back(count, what);
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (list.size() > kMax) list.resize(kMax);
  return list;
}

std::string results_table(const SystemResult& result) {
  std::string text = "Table 8.6: most frequent results of recognition\n";
  for (const auto& [count, what] : most_frequent(result))
    text += fmt::format("  {:>6}  {:<10}{}\n", count, what.first, what.second);
  return text + "\n";
}

std::string score_line(const std::string& name, const KindScore& score) {
  return fmt::format("  {:<12}{:>8}{:>8}{:>10}{:>9.1f} %{:>9.1f} %\n", name, score.there, score.found,
                     score.clusters, 100 * share(score.found, score.there),
                     100 * share(score.found, score.clusters));
}

std::string kinds_table(const SystemResult& result) {
  std::string text =
      fmt::format("Found by kind (IoU of at least a half)\n  {:<12}{:>8}{:>8}{:>10}{:>11}{:>11}\n", "",
                  "visible", "found", "clusters", "recall", "precision");
  for (const bool flat : {false, true})
    for (const auto& [name, kind] : result.kinds)
      if (kind.flat == flat) text += score_line(name, kind);
  text += score_line("solid", result.sum(false, true)) + score_line("flat", result.sum(true, false));
  KindScore all = result.sum(true, true);
  all.clusters += result.false_clusters;
  return text + score_line("all", all) +
         fmt::format("  clusters that are no object: {}; the memory holds {} objects, {} were used\n\n",
                     result.false_clusters, result.objects, result.true_objects);
}

std::string steps_table(const std::string& title, const std::vector<StepTime>& steps) {
  std::string text = fmt::format("{}\n  {:<26}{:>12}{:>16}\n", title, "ms per frame", "clock", "processor");
  for (const StepTime& step : steps)
    text += fmt::format("  {:<26}{:>12.2f}{:>16.2f}\n", step.name, step.clock_ms, step.processor_ms);
  return text;
}

Json histogram_json(const Histogram& histogram) {
  Json json = Json::object();
  for (const auto& [value, count] : histogram) json[std::to_string(value)] = count;
  return json;
}

Json types_json(const std::vector<TypeCount>& types) {
  Json json = Json::object();
  for (const TypeCount& type : types) json[type.type] = type.count;
  return json;
}

Json score_json(const KindScore& score) {
  return {{"flat", score.flat},
          {"visible", score.there},
          {"found", score.found},
          {"clusters", score.clusters},
          {"recall", share(score.found, score.there)},
          {"precision", share(score.found, score.clusters)}};
}

Json steps_json(const std::vector<StepTime>& steps) {
  Json json = Json::array();
  for (const StepTime& step : steps)
    json.push_back({{"name", step.name}, {"clock_ms", step.clock_ms}, {"processor_ms", step.processor_ms}});
  return json;
}

}  // namespace

std::string text_of(const SystemResult& result) {
  const Throughput& speed = result.throughput;
  return fmt::format("{} scenes, {} clusters\n\n", result.scenes, result.clusters) +
         counts_table("Table 8.1: flat objects per scene", published_flat(), result.flat_set,
                      result.flat_found) +
         counts_table("Table 8.2: three-dimensional objects per scene", published_solid(), result.solid_set,
                      result.solid_found) +
         counts_table("Table 8.3: objects per scene", published_total(), result.total_set,
                      result.total_found) +
         sizes_table(result.points) + annotations_table(result) + results_table(result) +
         "Table 8.7: every feature structure of all scenes\n" + types_table(result.kept_types) + "\n" +
         kinds_table(result) + steps_table("Everything, with the memory", result.steps) + "\n" +
         steps_table("The tabletop pipeline", speed.steps) +
         fmt::format(
             "  {:.1f} frames per second ({:.1f} ms of wall time each, {:.1f} ms of CPU time of the "
             "annotators)\n  resident memory {:.0f} MB after a tenth of {} frames, {:.0f} MB "
             "after half, {:.0f} MB at the end\n",
             speed.frames_per_second(), speed.clock_ms, speed.processor_ms, speed.megabytes_first_tenth,
             speed.frames, speed.megabytes_half, speed.megabytes_at_end);
}

Json json_of(const SystemResult& result) {
  Json json = {
      {"scenes", result.scenes},
      {"clusters", result.clusters},
      {"false_clusters", result.false_clusters},
      {"objects", result.true_objects},
      {"objects", result.objects},
      {"table_8_1", {{"set", histogram_json(result.flat_set)}, {"found", histogram_json(result.flat_found)}}},
      {"table_8_2",
       {{"set", histogram_json(result.solid_set)}, {"found", histogram_json(result.solid_found)}}},
      {"table_8_3",
       {{"set", histogram_json(result.total_set)}, {"found", histogram_json(result.total_found)}}},
      {"table_8_4", {{"mean", mean(result.points)}, {"per_thousand", size_bins(result.points)}}},
      {"table_8_5",
       {{"scenes", types_json(result.scene_types)}, {"clusters", types_json(result.cluster_types)}}},
      {"table_8_6", Json::array()},
      {"table_8_7", types_json(result.kept_types)},
      {"solid", score_json(result.sum(false, true))},
      {"flat", score_json(result.sum(true, false))},
      {"steps", steps_json(result.steps)}};
  for (const auto& [count, what] : most_frequent(result))
    json["table_8_6"].push_back({{"count", count}, {"category", what.first}, {"title", what.second}});
  for (const auto& [name, kind] : result.kinds) json["kinds"][name] = score_json(kind);
  const Throughput& speed = result.throughput;
  json["throughput"] = {{"frames", speed.frames},
                        {"frames_per_second", speed.frames_per_second()},
                        {"clock_ms", speed.clock_ms},
                        {"processor_ms", speed.processor_ms},
                        {"steps", steps_json(speed.steps)},
                        {"resident_mb",
                         {{"first_tenth", speed.megabytes_first_tenth},
                          {"half", speed.megabytes_half},
                          {"end", speed.megabytes_at_end}}}};
  return json;
}

}  // namespace loci::apps::system_evaluation
