#pragma once

#include <filesystem>
#include <string>

namespace loci {

/// A whole file without the byte-order mark that editors on Windows put first. Error as of read_file().
std::string read_text(const std::filesystem::path& path);

}  // namespace loci
