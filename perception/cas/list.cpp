#include <algorithm>

#include "perception/cas/cas.h"

namespace loci::perception::cas {

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
