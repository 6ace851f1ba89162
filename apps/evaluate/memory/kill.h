#pragma once

#include <filesystem>

#include "apps/evaluate/memory/figures.h"

namespace loci::apps::memory_experiment {

/// Kills a writer (SIGKILL) at random moments, again and again over one file, and looks each time whether
/// every scene that it had committed is there and the memory is sound.
void kill_writers(const MemoryOptions& options, const std::filesystem::path& file, MemoryFigures& figures,
                  Progress& progress);

}  // namespace loci::apps::memory_experiment
