#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/time.h"

namespace loci::gui {

/// A line of the log: an annotator with its times over all runs, a run that wrote to the memory, a scene, or
/// something that went wrong.
struct LogEntry {
  TimeNs time = 0;  ///< when the run was started, the scene was seen, or it went wrong; 0 = over all runs
  std::string what = {};
  std::string text = {};
  std::string details = {};          ///< all that is known, in lines
  bool is_problem = false;           ///< an error, or a run that did not finish
  std::optional<TimeNs> scene = {};  ///< the scene's time, which can be gone to
  int64_t scene_id = 0;              ///< 0 = of no scene
};

/// Annotators, the slowest first; then runs in order, each with its scenes below it. Error when the file
/// cannot be read.
std::vector<LogEntry> memory_log(const std::filesystem::path& path);

/// What annotators did in a scene and how long each took, a line each; or that it is not stored.
std::string annotator_log(const std::filesystem::path& path, int64_t scene);

/// What checking a whole memory file found, in lines: that it is sound with the rows of each table, or its
/// problems. A file that is no memory is such a problem, not an error.
std::string verify_memory(const std::filesystem::path& path, Progress& progress);

}  // namespace loci::gui
