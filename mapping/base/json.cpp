#include "mapping/base/json.h"

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci {

void check_json_depth(std::string_view text, const std::string& file) {
  int depth = 0, line = 1;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (quoted && c == '\\') {
      ++i;  // whatever it escapes
      continue;
    }
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxJsonDepth)
      throw Error("JSON that is nested too deeply", {file, line, {}},
                  "up to " + std::to_string(kMaxJsonDepth) + " levels can be read");
  }
}

Json parse_json(std::string_view text, const std::string& file) {
  check_json_depth(text, file);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw Error("not valid JSON", {file, static_cast<int>(line), {}}, "check the text around this line");
  } catch (const Json::exception& error) {  // well-formed, but a number is too large for any type
    throw Error("JSON that cannot be read: " + std::string(error.what()), {file, 0, {}});
  }
}

Json read_json(const std::filesystem::path& path) {
  return parse_json(read_file(path), path.string());
}

void write_json(const std::filesystem::path& path, const Json& json) {
  write_file_atomically(path, json.dump(2) + "\n");
}

}  // namespace loci
