#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "mapping/base/text/json_fwd.h"

namespace loci {

/// Text that is nested deeper is not parsed: programs walk through values by recursion.
inline constexpr int kMaxJsonDepth = 100;

/// Throws Error when JSON text is nested deeper than kMaxJsonDepth. `file` is for the message.
void check_json_depth(std::string_view text, const std::string& file);

/// Parses JSON text; throws Error with the line of the mistake, or when it is nested too deeply. `file` is
/// for the message.
Json parse_json(std::string_view text, const std::string& file);

/// Reads and parses a file.
Json read_json(const std::filesystem::path& path);

/// Writes atomically, indented, with a final newline.
void write_json(const std::filesystem::path& path, const Json& json);

}  // namespace loci
