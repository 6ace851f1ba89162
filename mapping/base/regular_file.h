#pragma once

#include <filesystem>

namespace loci {

/// Throws Error unless a regular file is there: a pipe may never say anything, a device never end.
void require_regular_file(const std::filesystem::path& path);

}  // namespace loci
