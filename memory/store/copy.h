#pragma once

#include <filesystem>

namespace loci::memory {

/// Copies a memory that nobody writes: then all of it is in the one file.
void copy_memory(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace loci::memory
