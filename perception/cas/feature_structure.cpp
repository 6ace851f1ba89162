#include "perception/cas/feature_structure.h"

#include <algorithm>
#include <limits>

#include "perception/cas/cas.h"

namespace loci::perception::cas {
namespace {

struct Bounds {
  int64_t low, high;
};

Bounds bounds_of(Kind kind) {
  switch (kind) {
    case Kind::kByte:
      return {std::numeric_limits<int8_t>::min(), std::numeric_limits<int8_t>::max()};
    case Kind::kShort:
      return {std::numeric_limits<int16_t>::min(), std::numeric_limits<int16_t>::max()};
    case Kind::kInteger:
      return {std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max()};
    default:
      return {std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()};
  }
}

std::string name_of(Feature feature) {
  return "feature '" + feature.name() + "' of " + feature.owner().name();
}

}  // namespace

bool FeatureStructure::is_deleted() const {
  return id_ != 0 && cas_->heap_[id_ - 1].deleted;
}

Cas& FeatureStructure::cas() const {
  if (cas_ == nullptr) throw Error("access to a null feature structure");
  return *cas_;
}

Type FeatureStructure::type() const {
  return cas().record(id_).type;
}

bool FeatureStructure::is_a(std::string_view type_name) const {
  return cas::is_a(type(), cas().type_system().type(type_name));
}

const Value& FeatureStructure::read(Feature feature) const {
  const Cas::Record& record = cas().record(id_);
  const auto& features = record.type.features();
  if (feature.slot() >= features.size() || features[feature.slot()] != feature)
    throw Error("type " + record.type.name() + " has no " + name_of(feature));
  return record.values[feature.slot()];
}

Value& FeatureStructure::write(Feature feature) const {
  read(feature);
  return cas().writable(id_).values[feature.slot()];
}

const Value& FeatureStructure::value(Feature feature) const {
  return read(feature);
}

bool FeatureStructure::is_set(Feature feature) const {
  return !std::holds_alternative<std::monostate>(read(feature));
}

void FeatureStructure::clear(Feature feature) const {
  write(feature) = std::monostate();
}

void FeatureStructure::wrong_kind(Feature feature, const char* asked) const {
  throw Error(name_of(feature) + " is a " + feature.range().name() + ", not " + asked);
}

int64_t FeatureStructure::get_integer(Feature feature, int64_t low, int64_t high) const {
  if (!is_integer(feature.range().kind())) wrong_kind(feature, "an integer");
  const int64_t* value = std::get_if<int64_t>(&read(feature));
  if (value == nullptr) return 0;
  if (*value < low || *value > high)
    throw Error(name_of(feature) + " holds " + std::to_string(*value) +
                ", which does not fit the integer asked for");
  return *value;
}

const std::string& FeatureStructure::text(Feature feature) const {
  static const std::string unset;
  if (feature.range().kind() != Kind::kString) wrong_kind(feature, "a String");
  const std::string* value = std::get_if<std::string>(&read(feature));
  return value == nullptr ? unset : *value;
}

void FeatureStructure::set(Feature feature, bool value) const {
  if (feature.range().kind() != Kind::kBoolean) wrong_kind(feature, "a Boolean");
  write(feature) = value;
}

void FeatureStructure::set_integer(Feature feature, int64_t value) const {
  const Kind kind = feature.range().kind();
  if (!is_integer(kind)) wrong_kind(feature, "an integer");
  const Bounds bounds = bounds_of(kind);
  if (value < bounds.low || value > bounds.high)
    throw Error(std::to_string(value) + " does not fit " + name_of(feature) + ", which is a " +
                feature.range().name());
  write(feature) = value;
}

void FeatureStructure::set(Feature feature, double value) const {
  const Kind kind = feature.range().kind();
  if (!is_floating(kind)) wrong_kind(feature, "a Float or Double");
  write(feature) = kind == Kind::kFloat ? static_cast<double>(static_cast<float>(value)) : value;
}

void FeatureStructure::set(Feature feature, std::string value) const {
  const Type range = feature.range();
  if (range.kind() != Kind::kString) wrong_kind(feature, "a String");
  const auto& allowed = range.allowed_values();
  if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    std::string all;
    for (const std::string& each : allowed) all += (all.empty() ? "" : ", ") + each;
    throw Error("'" + value + "' is not allowed for " + name_of(feature), {}, "one of: " + all);
  }
  write(feature) = std::move(value);
}

void FeatureStructure::set(Feature feature, const FeatureStructure& value) const {
  const Type range = feature.range();
  if (is_primitive(range.kind())) wrong_kind(feature, "a reference");
  if (value) {
    if (value.cas_ != cas_) throw Error(name_of(feature) + " cannot refer to another CAS");
    if (!cas::is_a(value.type(), range))
      throw Error(name_of(feature) + " is a " + range.name() + ", not a " + value.type().name());
    if (feature.has_element_type() && value.type().kind() == Kind::kArray &&
        value.type().component_kind() == Kind::kStructure)
      for (const FeatureStructure& element : value.structures())
        if (element && !element.is_deleted() && !cas::is_a(element.type(), feature.element_type()))
          throw Error(name_of(feature) + " holds elements of type " + feature.element_type().name() +
                      ", not " + element.type().name());
  }
  write(feature) = value ? Value(Reference{value.id_}) : Value(std::monostate());
}

FeatureStructure FeatureStructure::new_array(Kind component, const RawBuffer& values) const {
  return cas().create_array(component, values);
}

List FeatureStructure::list(Feature feature) const {
  return {*this, feature};
}

List FeatureStructure::list(std::string_view name) const {
  return list(feature(name));
}

size_t FeatureStructure::array_size() const {
  const Cas::Record& record = cas().record(id_);
  if (record.type.kind() != Kind::kArray) throw Error("type " + record.type.name() + " is no array");
  return record.type.component_kind() == Kind::kStructure ? record.elements.size() : record.buffer.size;
}

const RawBuffer& FeatureStructure::raw_elements(Kind component) const {
  const Cas::Record& record = cas().record(id_);
  const Type asked = cas_->type_system().array_type(component);
  if (record.type != asked || component == Kind::kStructure)
    throw Error("a " + record.type.name() + " cannot be read as elements of " + asked.name());
  return record.buffer;
}

FeatureStructure FeatureStructure::element(size_t index) const {
  const Cas::Record& record = cas().record(id_);
  if (index >= record.elements.size())
    throw Error("element " + std::to_string(index) + " of an array of " +
                std::to_string(record.elements.size()));
  return {cas_, record.elements[index]};
}

std::vector<FeatureStructure> FeatureStructure::structures() const {
  const Cas::Record& record = cas().record(id_);
  std::vector<FeatureStructure> found;
  found.reserve(record.elements.size());
  for (const uint32_t id : record.elements) found.emplace_back(cas_, id);
  return found;
}

void FeatureStructure::set_elements(const std::vector<FeatureStructure>& elements) const {
  Cas::Record& record = cas().writable(id_);
  if (record.type != cas_->type_system().array_type(Kind::kStructure))
    throw Error("type " + record.type.name() + " is no array of feature structures");
  std::vector<uint32_t> ids;
  for (const FeatureStructure& each : elements) {
    if (each && each.cas_ != cas_) throw Error("an array cannot refer to another CAS");
    ids.push_back(each.id_);
  }
  record.elements = std::move(ids);
}

void FeatureStructure::append(const FeatureStructure& element) const {
  Cas::Record& record = cas().writable(id_);
  if (record.type != cas_->type_system().array_type(Kind::kStructure))
    throw Error("type " + record.type.name() + " is no array of feature structures");
  if (element && element.cas_ != cas_) throw Error("an array cannot refer to another CAS");
  record.elements.push_back(element.id_);
}

void FeatureStructure::remove() const {
  cas().remove(*this);
}

void FeatureStructure::add_to_index(std::string_view view) const {
  cas().view(view).add_to_index(*this);
}

void FeatureStructure::remove_from_index(std::string_view view) const {
  cas().view(view).remove_from_index(*this);
}

List::List(FeatureStructure owner, Feature feature) : owner_(owner), feature_(feature) {
  const TypeSystem& types = owner_.cas().type_system();
  const Type range = feature_.range();
  if (range == types.array_type(Kind::kStructure)) {
    is_array_ = true;
  } else if (const auto component = types.list_component(range)) {
    component_ = *component;
  } else {
    throw Error("feature '" + feature_.name() + "' of " + feature_.owner().name() + " is a " + range.name() +
                ", not a list");
  }
}

void List::check(const FeatureStructure& element) const {
  if (element && !is_a(element.type(), feature_.element_type()))
    throw Error("feature '" + feature_.name() + "' of " + feature_.owner().name() +
                " holds elements of type " + feature_.element_type().name() + ", not " +
                element.type().name());
}

void List::expect(Kind component) const {
  if (component_ != component)
    throw Error("feature '" + feature_.name() + "' of " + feature_.owner().name() + " is a " +
                feature_.range().name() + ", whose elements are of another type");
}

std::vector<FeatureStructure> List::nodes() const {
  const TypeSystem& types = owner_.cas().type_system();
  const Type node_type = types.list_types(component_).node;
  std::vector<FeatureStructure> nodes;
  FeatureStructure node = owner_.get<FeatureStructure>(feature_);
  while (node && is_a(node.type(), node_type)) {
    if (nodes.size() > owner_.cas().size())
      throw Error("the list in feature '" + feature_.name() + "' of " + feature_.owner().name() +
                  " has no end");
    nodes.push_back(node);
    node = node.get<FeatureStructure>("tail");
  }
  return nodes;
}

FeatureStructure List::new_node() const {
  return owner_.cas().create(owner_.cas().type_system().list_types(component_).node);
}

void List::set_nodes(const std::vector<FeatureStructure>& nodes) const {
  FeatureStructure tail = owner_.cas().create(owner_.cas().type_system().list_types(component_).empty);
  for (size_t i = nodes.size(); i-- > 0;) {
    nodes[i].set("tail", tail);
    tail = nodes[i];
  }
  owner_.set(feature_, tail);
}

size_t List::size() const {
  if (!is_array_) return nodes().size();
  const FeatureStructure array = owner_.get<FeatureStructure>(feature_);
  return array ? array.array_size() : 0;
}

FeatureStructure List::at(size_t index) const {
  expect(Kind::kStructure);
  if (is_array_) {
    if (const FeatureStructure array = owner_.get<FeatureStructure>(feature_)) return array.element(index);
  } else if (const auto all = nodes(); index < all.size()) {
    return all[index].get<FeatureStructure>("head");
  }
  throw Error("element " + std::to_string(index) + " of the list '" + feature_.name() + "' of " +
              std::to_string(size()));
}

std::vector<FeatureStructure> List::structures() const {
  expect(Kind::kStructure);
  if (is_array_) {
    const FeatureStructure array = owner_.get<FeatureStructure>(feature_);
    return array ? array.structures() : std::vector<FeatureStructure>();
  }
  std::vector<FeatureStructure> found;
  for (const FeatureStructure& node : nodes()) found.push_back(node.get<FeatureStructure>("head"));
  return found;
}

void List::push_back(const FeatureStructure& element) const {
  expect(Kind::kStructure);
  check(element);
  if (is_array_) {
    FeatureStructure array = owner_.get<FeatureStructure>(feature_);
    if (!array) owner_.set(feature_, array = owner_.cas().create_array(std::vector<FeatureStructure>()));
    array.append(element);
    return;
  }
  const auto all = nodes();
  const FeatureStructure node = new_node();
  node.set("head", element);
  node.set("tail", owner_.cas().create(owner_.cas().type_system().list_types(component_).empty));
  if (all.empty())
    owner_.set(feature_, node);
  else
    all.back().set("tail", node);
}

void List::assign(const std::vector<FeatureStructure>& elements) const {
  expect(Kind::kStructure);
  for (const FeatureStructure& element : elements) check(element);
  if (is_array_) {
    const FeatureStructure array = owner_.get<FeatureStructure>(feature_);
    if (array)
      array.set_elements(elements);
    else
      owner_.set(feature_, owner_.cas().create_array(elements));
    return;
  }
  std::vector<FeatureStructure> all;
  for (const FeatureStructure& element : elements) {
    all.push_back(new_node());
    all.back().set("head", element);
  }
  set_nodes(all);
}

bool List::erase(const FeatureStructure& element) const {
  auto elements = structures();
  const auto found = std::find(elements.begin(), elements.end(), element);
  if (found == elements.end()) return false;
  elements.erase(found);
  if (is_array_)
    owner_.get<FeatureStructure>(feature_).set_elements(elements);
  else
    assign(elements);
  return true;
}

void List::clear() const {
  if (is_array_) {
    if (const FeatureStructure array = owner_.get<FeatureStructure>(feature_)) array.set_elements({});
  } else if (owner_.is_set(feature_)) {
    set_nodes({});
  }
}

template <typename T>
std::vector<T> List::values() const {
  expect(kind_of<T>());
  std::vector<T> found;
  for (const FeatureStructure& node : nodes()) found.push_back(node.get<T>("head"));
  return found;
}

template <typename T>
void List::assign_values(const std::vector<T>& values) const {
  expect(kind_of<T>());
  std::vector<FeatureStructure> all;
  for (const T& value : values) {
    all.push_back(new_node());
    all.back().set("head", value);
  }
  set_nodes(all);
}

template <typename T>
void List::push_back_value(const T& value) const {
  auto all = values<T>();
  all.push_back(value);
  assign_values(all);
}

template std::vector<std::string> List::values() const;
template std::vector<int32_t> List::values() const;
template std::vector<float> List::values() const;
template void List::assign_values(const std::vector<std::string>&) const;
template void List::assign_values(const std::vector<int32_t>&) const;
template void List::assign_values(const std::vector<float>&) const;
template void List::push_back_value(const std::string&) const;
template void List::push_back_value(const int32_t&) const;
template void List::push_back_value(const float&) const;

}  // namespace loci::perception::cas
