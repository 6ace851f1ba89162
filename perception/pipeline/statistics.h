#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "mapping/base/text/json_fwd.h"

namespace loci::perception {

/// What is known about an annotator from its runs (§2.2, principle 3): how long it takes, how often it fails,
/// and how often and how surely it has something to say.
struct AnnotatorStatistics {
  int64_t scenes = 0;    ///< that it was run on
  int64_t clusters = 0;  ///< that there were in them
  double seconds = 0;
  int64_t failures = 0;  ///< scenes on which it failed for good
  int64_t timeouts = 0;  ///< of these, because it took too long
  int64_t retries = 0;
  int64_t reused = 0;  ///< clusters that looked as before, so that it was not asked again

  /// Of one type of annotations.
  struct Product {
    int64_t made = 0;
    int64_t with_confidence = 0;
    double confidence_sum = 0;
  };
  std::map<std::string, Product> products;  ///< by short type name

  void add(const AnnotatorStatistics& more);
  double seconds_per_scene() const;
  /// Annotations of a type per cluster, at most 1: how often it has an answer. Unset runs: `prior`.
  double answer_rate(const std::string& type, double prior) const;
  /// Mean confidence of a type's annotations; `prior` when it gives none.
  double confidence(const std::string& type, double prior) const;
};

/// Statistics by annotator, kept over runs in a JSON file.
using StatisticsTable = std::map<std::string, AnnotatorStatistics>;

/// An absent file is an empty table. Error that names the place when it is none of ours.
StatisticsTable read_statistics(const std::filesystem::path& path);
/// Adds a run's statistics to the file, which is replaced as a whole.
void add_to_statistics(const std::filesystem::path& path, const StatisticsTable& run);
/// Where the statistics of runs with this memory are kept: beside it.
std::filesystem::path statistics_path(const std::filesystem::path& memory);

Json to_json(const AnnotatorStatistics& statistics);
/// "42 scenes, 3.1 ms each; ColorAnnotation for 98 % of 120 clusters", for people.
std::string statistics_text(const AnnotatorStatistics& statistics);

}  // namespace loci::perception
