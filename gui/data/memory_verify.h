#pragma once

#include <filesystem>
#include <string>

#include "mapping/base/progress.h"

namespace loci::gui {

/// What checking a whole memory file found, in lines: that it is sound with the rows of each table, or its
/// problems. A file that is no memory is such a problem, not an error.
std::string verify_memory(const std::filesystem::path& path, Progress& progress);

}  // namespace loci::gui
