#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace loci::memory {

/// How an annotator did over all runs that wrote to a memory.
struct AnnotatorTimes {
  std::string name = {};
  int64_t scenes = 0;
  double seconds = 0;  ///< in all
  int64_t failures = 0, timeouts = 0, retries = 0;

  double ms_per_scene() const { return scenes == 0 ? 0 : seconds * 1000 / static_cast<double>(scenes); }
};

/// From the statistics that pipelines keep beside a memory (MEMORY.statistics.json); the slowest first. Empty
/// when there are none; Error when the file is none of ours.
std::vector<AnnotatorTimes> annotator_times(const std::filesystem::path& memory);

}  // namespace loci::memory
