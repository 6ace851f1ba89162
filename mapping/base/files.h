#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace loci {

/// Throws Error unless a regular file is there: a pipe may never say anything, a device never end.
void require_regular_file(const std::filesystem::path& path);

/// The whole file as bytes. Throws Error when it does not exist or cannot be read.
std::string read_file(const std::filesystem::path& path);

/// write_output() that replaces any file: for files in a folder that loci made.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Creates a folder and its parents; throws Error when that fails or a file is in the way.
void make_folder(const std::filesystem::path& path);

/// Throws Error when a folder that does not exist yet would be named like a file ("map.urdf", "day.zip"):
/// whoever writes this expects one.
void check_folder_name(const std::filesystem::path& path);

}  // namespace loci
