#include "perception/cas/cas.h"

#include <algorithm>
#include <utility>

namespace loci::perception::cas {

Cas::Cas(std::shared_ptr<const TypeSystem> type_system) : type_system_(std::move(type_system)) {
  if (!type_system_) throw Error("a CAS needs a type system");
}

FeatureStructure Cas::create(Type type) {
  if (!type || is_primitive(type.kind()))
    throw Error("cannot create a feature structure of type " + (type ? type.name() : "(none)"));
  Record record;
  record.type = type;
  record.values.resize(type.features().size());
  heap_.push_back(std::move(record));
  return {this, static_cast<uint32_t>(heap_.size())};
}

FeatureStructure Cas::create_array(Kind component, RawBuffer values) {
  const FeatureStructure array = create(type_system_->array_type(component));
  writable(array.id()).buffer = std::move(values);
  return array;
}

FeatureStructure Cas::create_array(const std::vector<FeatureStructure>& elements) {
  const FeatureStructure array = create(type_system_->array_type(Kind::kStructure));
  array.set_elements(elements);
  return array;
}

const Cas::Record& Cas::record(uint32_t id) const {
  if (id == 0 || id > heap_.size()) throw Error("access to a null feature structure");
  const Record& found = heap_[id - 1];
  if (found.deleted) throw Error("access to a deleted feature structure of type " + found.type.name());
  return found;
}

Cas::Record& Cas::writable(uint32_t id) {
  auto& found = const_cast<Record&>(record(id));
  if (!journals_.empty()) remember(id, found);
  return found;
}

View& Cas::view(std::string_view name) {
  if (View* found = find_view(name)) return *found;
  auto view = std::make_unique<View>(*this, std::string(name));
  if (!journals_.empty()) journals_.back().views.emplace_back(name);
  return *views_.emplace(std::string(name), std::move(view)).first->second;
}

View* Cas::find_view(std::string_view name) {
  const auto found = views_.find(name);
  return found == views_.end() ? nullptr : found->second.get();
}

const View* Cas::find_view(std::string_view name) const {
  const auto found = views_.find(name);
  return found == views_.end() ? nullptr : found->second.get();
}

std::vector<std::string> Cas::view_names() const {
  std::vector<std::string> names;
  for (const auto& [name, view] : views_) names.push_back(name);
  return names;
}

Selection Cas::select(std::string_view type_name, std::string_view view) const {
  const Type type = type_system_->type(type_name);
  const View* found = find_view(view);
  return found == nullptr ? Selection({}) : found->select(type);
}

void Cas::remove(const FeatureStructure& structure) {
  Record& removed = writable(structure.id());
  for (auto& [name, view] : views_) {
    view->remove_from_index(structure);
    if (view->sofa_ == structure) view->replace_sofa({});
  }
  removed.deleted = true;
  removed.values = {};
  removed.buffer = {};
  removed.elements = {};
}

}  // namespace loci::perception::cas
