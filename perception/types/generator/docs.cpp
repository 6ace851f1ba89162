#include "perception/types/generator/docs.h"

#include <fmt/format.h>

#include "mapping/base/files.h"
#include "perception/cas/type_system.h"

namespace loci::generator {

using cas::Feature;
using cas::Type;

namespace {

/// Bars would end a cell.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string range_text(const Feature& feature) {
  if (feature.has_element_type())
    return fmt::format("{} of {}", feature.range().short_name(), feature.element_type().short_name());
  return feature.range().short_name();
}

std::string type_text(Type type) {
  std::string text = fmt::format("\n### {}\n\n`{}`, a {}. {}\n", type.short_name(), type.name(),
                                 type.supertype().short_name(), type.description());
  if (!type.allowed_values().empty()) {
    std::string values;
    for (const std::string& value : type.allowed_values())
      values += (values.empty() ? "`" : ", `") + value + "`";
    text += "\nAllowed: " + values + "\n";
  }
  const auto features = type.own_features();
  if (features.empty()) return text;
  text += "\n| feature | holds | meaning |\n|---|---|---|\n";
  for (const Feature& feature : features)
    text +=
        fmt::format("| {} | {} | {} |\n", feature.name(), range_text(feature), cell(feature.description()));
  return text;
}

}  // namespace

void write_docs(const std::filesystem::path& output, const std::vector<std::filesystem::path>& files) {
  const auto system = cas::TypeSystem::load(files);
  std::string text =
      "# Type system\n\nGenerated from perception/types/*.xml by `ninja -C build/release type_system_docs`. "
      "Metres, "
      "radians, nanoseconds since 1970 (UTC); `map_from_x` maps coordinates of x to the map.\n";
  for (const auto& file : files) {
    text += fmt::format("\n## {}\n", file.stem().string());
    for (const Type& type : system->types())
      if (type.place().file == file.string()) text += type_text(type);
  }
  write_file_atomically(output, text);
}

}  // namespace loci::generator
