#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "mapping/base/json_fwd.h"

namespace loci {

/// Parses JSON text; throws Error with the line of the mistake. `file` is for the message.
Json parse_json(std::string_view text, const std::string& file);

/// Reads and parses a file.
Json read_json(const std::filesystem::path& path);

/// Writes atomically, indented, with a final newline.
void write_json(const std::filesystem::path& path, const Json& json);

}  // namespace loci
