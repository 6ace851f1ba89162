#include "perception/pipeline/statistics.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci::perception {
namespace {

AnnotatorStatistics from_json(const Json& json) {
  AnnotatorStatistics read;
  read.scenes = json.at("scenes").get<int64_t>();
  read.clusters = json.at("clusters").get<int64_t>();
  read.seconds = json.at("seconds").get<double>();
  read.failures = json.at("failures").get<int64_t>();
  read.timeouts = json.at("timeouts").get<int64_t>();
  read.retries = json.at("retries").get<int64_t>();
  read.reused = json.at("reused").get<int64_t>();
  for (const auto& [type, product] : json.at("makes").items())
    read.products[type] = {product.at("made").get<int64_t>(), product.at("with_confidence").get<int64_t>(),
                           product.at("confidence_sum").get<double>()};
  return read;
}

}  // namespace

void AnnotatorStatistics::add(const AnnotatorStatistics& more) {
  scenes += more.scenes;
  clusters += more.clusters;
  seconds += more.seconds;
  failures += more.failures;
  timeouts += more.timeouts;
  retries += more.retries;
  reused += more.reused;
  for (const auto& [type, product] : more.products) {
    Product& sum = products[type];
    sum.made += product.made;
    sum.with_confidence += product.with_confidence;
    sum.confidence_sum += product.confidence_sum;
  }
}

double AnnotatorStatistics::seconds_per_scene() const {
  return scenes == 0 ? 0 : seconds / static_cast<double>(scenes);
}

double AnnotatorStatistics::answer_rate(const std::string& type, double prior) const {
  if (clusters == 0) return prior;
  const auto found = products.find(type);
  const double made = found == products.end() ? 0 : static_cast<double>(found->second.made);
  return std::min(1.0, made / static_cast<double>(clusters));
}

double AnnotatorStatistics::confidence(const std::string& type, double prior) const {
  const auto found = products.find(type);
  if (found == products.end() || found->second.with_confidence == 0) return prior;
  return found->second.confidence_sum / static_cast<double>(found->second.with_confidence);
}

Json to_json(const AnnotatorStatistics& statistics) {
  Json makes = Json::object();
  for (const auto& [type, product] : statistics.products)
    makes[type] = {{"made", product.made},
                   {"with_confidence", product.with_confidence},
                   {"confidence_sum", product.confidence_sum}};
  return {{"scenes", statistics.scenes},     {"clusters", statistics.clusters},
          {"seconds", statistics.seconds},   {"failures", statistics.failures},
          {"timeouts", statistics.timeouts}, {"retries", statistics.retries},
          {"reused", statistics.reused},     {"makes", makes}};
}

StatisticsTable read_statistics(const std::filesystem::path& path) {
  StatisticsTable table;
  if (!std::filesystem::exists(path)) return table;
  const Json json = read_json(path);
  try {
    for (const auto& [name, statistics] : json.at("annotators").items()) table[name] = from_json(statistics);
  } catch (const Json::exception&) {
    throw Error("these are no statistics of annotators", {path.string(), 0, {}},
                "remove the file: it is made anew");
  }
  return table;
}

void add_to_statistics(const std::filesystem::path& path, const StatisticsTable& run) {
  StatisticsTable table = read_statistics(path);
  for (const auto& [name, statistics] : run) table[name].add(statistics);
  Json json = {{"version", 1}, {"annotators", Json::object()}};
  for (const auto& [name, statistics] : table) json["annotators"][name] = to_json(statistics);
  write_json(path, json);
}

std::filesystem::path statistics_path(const std::filesystem::path& memory) {
  std::filesystem::path path = memory;
  path.replace_extension(".statistics.json");
  return path;
}

std::string statistics_text(const AnnotatorStatistics& statistics) {
  std::string text =
      fmt::format("{} scenes, {:.1f} ms each", statistics.scenes, statistics.seconds_per_scene() * 1e3);
  if (statistics.failures > 0)
    text += fmt::format(", failed on {} ({} by time-out)", statistics.failures, statistics.timeouts);
  if (statistics.retries > 0) text += fmt::format(", tried {} times again", statistics.retries);
  for (const auto& [type, product] : statistics.products) {
    text += fmt::format("; {} {}", product.made, type);
    if (statistics.clusters > 0)
      text += fmt::format(" ({:.0f} % of {} clusters)", 100 * statistics.answer_rate(type, 0),
                          statistics.clusters);
    if (product.with_confidence > 0)
      text += fmt::format(", mean confidence {:.2f}", statistics.confidence(type, 0));
  }
  if (statistics.reused > 0) text += fmt::format("; {} clusters looked as before", statistics.reused);
  return text;
}

}  // namespace loci::perception
