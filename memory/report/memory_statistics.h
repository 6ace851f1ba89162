#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/progress.h"

namespace loci::memory {

class Store;

/// A bar per name.
struct Chart {
  std::string title = {};
  std::string unit = {};  ///< what is counted: "observations"
  std::vector<std::pair<std::string, double>> bars = {};
};

/// Statistics of a whole memory: observations and annotations by type (Tables 8.5, 8.7), flat, higher and all
/// observations per scene and their sizes (Tables 8.1 to 8.4), distinct objects by hour of the day and by
/// place, probabilities of associations, and times of annotators. Reads everything. Interrupted when
/// `progress` stops it.
std::vector<Chart> memory_statistics(const Store& store, Progress& progress);

/// "chart,name,value" with one row per bar.
std::string statistics_csv(const std::vector<Chart>& charts);

/// The work of an annotator in all runs that wrote to a memory.
struct AnnotatorTimes {
  std::string name = {};
  int64_t scenes = 0;
  double seconds = 0;  ///< of all scenes
  int64_t failures = 0, timeouts = 0, retries = 0;

  double ms_per_scene() const { return scenes == 0 ? 0 : seconds * 1000 / static_cast<double>(scenes); }
};

/// From the statistics that pipelines write beside a memory (MEMORY.statistics.json), the slowest first.
/// Empty without the file; Error when the file has another format.
std::vector<AnnotatorTimes> annotator_times(const std::filesystem::path& memory);

}  // namespace loci::memory
