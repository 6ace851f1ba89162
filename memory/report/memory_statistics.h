#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/progress.h"

namespace loci {

/// A bar per name.
struct Chart {
  std::string title = {};
  std::string unit = {};  ///< what is counted: "observations"
  std::vector<std::pair<std::string, double>> bars = {};
};

/// Numbers about a whole memory: observations and annotations by type, distinct objects by hour of the day
/// and by place, and how sure the identities are. Reads everything, so it takes a while on long memories.
/// Error when the file cannot be read, Interrupted when it is told to stop.
std::vector<Chart> memory_statistics(const std::filesystem::path& path, Progress& progress);

/// "chart,name,value" with one row per bar.
std::string statistics_csv(const std::vector<Chart>& charts);

}  // namespace loci
