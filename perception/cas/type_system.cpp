#include "perception/cas/type_system.h"

#include <fmt/format.h>
#include <algorithm>

#include "mapping/base/text/json.h"

namespace loci::perception::cas {
namespace {

template <typename T>
std::optional<T> find_sorted(const std::vector<std::pair<std::string_view, T>>& entries,
                             std::string_view name) {
  const auto found =
      std::lower_bound(entries.begin(), entries.end(), name,
                       [](const auto& entry, std::string_view key) { return entry.first < key; });
  if (found == entries.end() || found->first != name) return std::nullopt;
  return found->second;
}

/// The features of a type that UIMA does not bring along.
std::vector<Feature> declared_features(const Type& type) {
  const auto builtin = TypeSystem::builtin()->find(type.name());
  std::vector<Feature> declared;
  for (const Feature& feature : type.own_features())
    if (!builtin || !builtin->find_feature(feature.name())) declared.push_back(feature);
  return declared;
}

/// The types that UIMA does not bring along, or that got features beside its own.
std::vector<Type> declared_types(const TypeSystem& system) {
  std::vector<Type> declared;
  for (const Type& type : system.types())
    if (!type.is_builtin() || !declared_features(type).empty()) declared.push_back(type);
  std::sort(declared.begin(), declared.end(), [](Type one, Type two) { return one.name() < two.name(); });
  return declared;
}

size_t count_features(const std::vector<Type>& types) {
  size_t count = 0;
  for (const Type& type : types) count += declared_features(type).size();
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

const std::string& Type::name() const {
  return data_->name;
}

std::string Type::short_name() const {
  return data_->name.substr(data_->name.rfind('.') + 1);
}

const std::string& Type::description() const {
  return data_->description;
}

Type Type::supertype() const {
  return Type(data_->supertype);
}

Kind Type::kind() const {
  return data_->kind;
}

Kind Type::component_kind() const {
  return data_->component;
}

bool Type::is_builtin() const {
  return data_->builtin;
}

const FileLocation& Type::location() const {
  return data_->place;
}

const std::vector<Feature>& Type::features() const {
  return data_->features;
}

std::vector<Feature> Type::own_features() const {
  std::vector<Feature> own;
  for (const auto& feature : data_->own) own.emplace_back(feature.get());
  return own;
}

std::optional<Feature> Type::find_feature(std::string_view name) const {
  return find_sorted(data_->by_name, name);
}

Feature Type::feature(std::string_view name) const {
  if (const auto found = find_feature(name)) return *found;
  std::vector<std::string> names;
  for (const Feature& each : features()) names.push_back(each.name());
  throw Error("type " + this->name() + " has no feature '" + std::string(name) + "'", {},
              did_you_mean(name, names));
}

const std::vector<std::string>& Type::allowed_values() const {
  return data_->allowed_values;
}

int Type::order() const {
  return data_->order;
}

int Type::last_order() const {
  return data_->last_order;
}

const std::string& Feature::name() const {
  return data_->name;
}

const std::string& Feature::description() const {
  return data_->description;
}

Type Feature::range() const {
  return Type(data_->range);
}

Type Feature::element_type() const {
  return Type(data_->element);
}

bool Feature::has_element_type() const {
  return data_->has_element;
}

bool Feature::multiple_references_allowed() const {
  return data_->multiple_references;
}

Type Feature::owner() const {
  return Type(data_->owner);
}

size_t Feature::slot() const {
  return data_->slot;
}

std::optional<Type> TypeSystem::find(std::string_view name) const {
  return find_sorted(by_name_, name);
}

Type TypeSystem::type(std::string_view name) const {
  if (const auto found = find(name)) return *found;
  std::vector<std::string> names;
  for (const Type& each : types_) names.push_back(each.name());
  throw Error("unknown type '" + std::string(name) + "'", {}, did_you_mean(name, names));
}

Type TypeSystem::array_type(Kind component) const {
  return arrays_.at(static_cast<size_t>(component));
}

std::vector<Type> TypeSystem::subtypes(Type type) const {
  return {types_.begin() + type.order(), types_.begin() + type.last_order() + 1};
}

const TypeSystem::ListTypes& TypeSystem::list_types(Kind component) const {
  switch (component) {
    case Kind::kStructure:
      return fs_list_;
    case Kind::kString:
      return string_list_;
    case Kind::kInteger:
      return integer_list_;
    case Kind::kFloat:
      return float_list_;
    default:
      throw Error("there are lists of feature structures, strings, integers and floats only");
  }
}

std::optional<Kind> TypeSystem::list_component(Type type) const {
  for (const Kind kind : {Kind::kStructure, Kind::kString, Kind::kInteger, Kind::kFloat})
    if (is_a(type, list_types(kind).list)) return kind;
  return std::nullopt;
}

std::string types_text(const TypeSystem& system) {
  const std::vector<Type> types = declared_types(system);
  std::string text = fmt::format("{} types with {} features\n", types.size(), count_features(types));
  for (const Type& type : types) {
    const std::vector<Feature> features = declared_features(type);
    const size_t inherited = type.features().size() - features.size();
    text += fmt::format("\n{} : {}", type.name(), type.supertype().name());
    if (inherited > 0) text += fmt::format(" ({} inherited)", inherited);
    text += '\n';
    if (!type.allowed_values().empty())
      text += fmt::format("  one of {}\n", fmt::join(type.allowed_values(), ", "));
    for (const Feature& feature : features)
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
