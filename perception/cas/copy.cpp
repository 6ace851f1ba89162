#include "perception/cas/copy.h"

#include <vector>

#include "mapping/base/error.h"
#include "perception/cas/graph.h"

namespace loci::perception::cas {

Copier::Copier(const Cas& from, Cas& to) : to_(to) {
  if (&from.type_system() != &to.type_system())
    throw Error("feature structures are copied within one type system only");
}

void Copier::stand_in(const FeatureStructure& original, const FeatureStructure& copy) {
  copies_[original.id()] = copy;
}

FeatureStructure Copier::operator()(const FeatureStructure& structure) {
  if (structure.is_null() || structure.is_deleted()) return {};
  // What stands for a structure hides what that refers to, so the way is walked here.
  std::vector<FeatureStructure> fresh;
  const auto add = [&](const FeatureStructure& each) {
    if (copies_.contains(each.id())) return;
    copies_.emplace(each.id(), shell_of(each));
    fresh.push_back(each);
  };
  add(structure);
  for (size_t next = 0; next < fresh.size(); ++next) {
    const FeatureStructure current = fresh[next];
    for_each_reference(current, [&](Feature, const FeatureStructure& target) { add(target); });
  }
  for (const FeatureStructure& each : fresh) fill(each, copies_.at(each.id()));
  return copies_.at(structure.id());
}

FeatureStructure Copier::shell_of(const FeatureStructure& original) {
  const Type type = original.type();
  if (type.kind() != Kind::kArray) return to_.create(type);
  const Kind component = type.component_kind();
  if (component == Kind::kStructure) return to_.create_array(std::vector<FeatureStructure>());
  return to_.create_array(component, original.raw_elements(component));
}

FeatureStructure Copier::target_of(const FeatureStructure& original) const {
  const auto found = copies_.find(original.id());
  return found == copies_.end() ? FeatureStructure() : found->second;
}

void Copier::fill(const FeatureStructure& original, const FeatureStructure& copy) {
  const Type type = original.type();
  if (type.kind() == Kind::kArray) {
    if (type.component_kind() != Kind::kStructure) return;
    std::vector<FeatureStructure> elements;
    for (const FeatureStructure& each : original.structures()) elements.push_back(target_of(each));
    return copy.set_elements(elements);
  }
  for (const Feature& feature : type.features()) {
    const Value& value = original.value(feature);
    if (const bool* flag = std::get_if<bool>(&value)) copy.set(feature, *flag);
    if (const auto* integer = std::get_if<int64_t>(&value)) copy.set(feature, *integer);
    if (const auto* number = std::get_if<double>(&value)) copy.set(feature, *number);
    if (const auto* text = std::get_if<std::string>(&value)) copy.set(feature, *text);
    if (std::holds_alternative<Reference>(value))
      copy.set(feature, target_of(original.get<FeatureStructure>(feature)));
  }
}

}  // namespace loci::perception::cas
