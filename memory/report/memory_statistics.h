#pragma once

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

/// Numbers about a whole memory: observations and annotations by type (Tables 8.5, 8.7), flat, higher and all
/// things per scene and their sizes (Tables 8.1 to 8.4), distinct objects by hour of the day and by place,
/// how sure the identities are, and what annotators took. Reads everything, so it takes a while on long
/// memories. Interrupted when it is told to stop.
std::vector<Chart> memory_statistics(const Store& store, Progress& progress);

/// "chart,name,value" with one row per bar.
std::string statistics_csv(const std::vector<Chart>& charts);

}  // namespace loci::memory
