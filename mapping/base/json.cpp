#include "mapping/base/json.h"

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci {

Json parse_json(std::string_view text, const std::string& file) {
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
