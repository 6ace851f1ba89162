#pragma once

#include <filesystem>
#include <memory>

#include "gui/data/browser_data.h"

namespace loci {

/// A memory file as the browser shows it; opened for reading, never changed. Error when it is missing, broken
/// or of a newer version.
std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path);

}  // namespace loci
