#include "perception/cas/listing.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/json.h"

namespace loci::perception::cas {

namespace {

std::vector<Type> declared_types(const TypeSystem& system) {
  std::vector<Type> declared;
  for (const Type& type : system.types())
    if (!type.is_builtin()) declared.push_back(type);
  std::sort(declared.begin(), declared.end(), [](Type one, Type two) { return one.name() < two.name(); });
  return declared;
}

size_t count_features(const std::vector<Type>& types) {
  size_t count = 0;
  for (const Type& type : types) count += type.own_features().size();
  return count;
}

std::string range_text(const Feature& feature) {
  return feature.has_element_type()
             ? fmt::format("{} of {}", feature.range().name(), feature.element_type().name())
             : feature.range().name();
}

Json feature_json(const Feature& feature, Type type) {
  Json json = {{"name", feature.name()}, {"range", feature.range().name()}};
  if (feature.has_element_type()) json["element"] = feature.element_type().name();
  if (feature.multiple_references_allowed()) json["multiple_references_allowed"] = true;
  if (!feature.description().empty()) json["description"] = feature.description();
  if (feature.owner() != type) json["inherited_from"] = feature.owner().name();
  return json;
}

}  // namespace

std::string types_text(const TypeSystem& system) {
  const std::vector<Type> types = declared_types(system);
  std::string text = fmt::format("{} types with {} features\n", types.size(), count_features(types));
  for (const Type& type : types) {
    const size_t inherited = type.features().size() - type.own_features().size();
    text += fmt::format("\n{} : {}", type.name(), type.supertype().name());
    if (inherited > 0) text += fmt::format(" ({} inherited)", inherited);
    text += '\n';
    if (!type.allowed_values().empty())
      text += fmt::format("  one of {}\n", fmt::join(type.allowed_values(), ", "));
    for (const Feature& feature : type.own_features())
      text += fmt::format("  {:<24} {}\n", feature.name(), range_text(feature));
  }
  return text;
}

Json types_json(const TypeSystem& system) {
  const std::vector<Type> types = declared_types(system);
  Json list = Json::array();
  for (const Type& type : types) {
    Json entry = {{"name", type.name()}, {"supertype", type.supertype().name()}};
    entry["file"] = type.location().file;
    entry["line"] = type.location().line;
    if (!type.description().empty()) entry["description"] = type.description();
    if (!type.allowed_values().empty()) entry["allowed_values"] = type.allowed_values();
    entry["features"] = Json::array();
    for (const Feature& feature : type.features()) entry["features"].push_back(feature_json(feature, type));
    list.push_back(std::move(entry));
  }
  return {{"types", types.size()}, {"features", count_features(types)}, {"type", std::move(list)}};
}

}  // namespace loci::perception::cas
