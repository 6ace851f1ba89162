#pragma once

#include <filesystem>
#include <memory>

#include "gui/data/browser_data.h"
#include "mapping/base/progress.h"

namespace loci::gui {

/// A memory file as the browser shows it; opened for reading, never changed. Error when it is missing, broken
/// or of a newer version, Interrupted when it is told to stop.
std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path, Progress& progress);
std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path);

}  // namespace loci::gui
