#include "perception/cas/graph.h"

#include <algorithm>
#include <bit>
#include <unordered_set>
#include <vector>

#include "mapping/base/error.h"

namespace loci::perception::cas {
namespace {

uint64_t mixed(uint64_t hash, uint64_t value) {
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2);
  hash ^= hash >> 31;
  hash *= 0xbf58476d1ce4e5b9ULL;
  return hash ^ (hash >> 29);
}

uint64_t hash_bytes(const void* data, size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  uint64_t hash = mixed(size, 0x51ed270b);
  for (; size >= 8; size -= 8, bytes += 8) {
    uint64_t word = 0;
    std::memcpy(&word, bytes, 8);
    hash = mixed(hash, word);
  }
  uint64_t rest = 0;
  if (size > 0) std::memcpy(&rest, bytes, size);
  return mixed(hash, rest);
}

uint64_t hash_text(std::string_view text) {
  return hash_bytes(text.data(), text.size());
}

uint64_t hash_value(const Value& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? 3 : 2;
  if (const int64_t* number = std::get_if<int64_t>(&value)) return static_cast<uint64_t>(*number);
  if (const double* number = std::get_if<double>(&value)) return std::bit_cast<uint64_t>(*number);
  if (const std::string* text = std::get_if<std::string>(&value)) return hash_text(*text);
  return 0;
}

/// What a structure says by itself: type, primitive values, elements that are no references.
uint64_t hash_content(const FeatureStructure& structure) {
  const Type type = structure.type();
  uint64_t hash = hash_text(type.name());
  for (const Feature& feature : type.features()) {
    const Value& value = structure.value(feature);
    hash = mixed(mixed(hash, value.index()), hash_value(value));
  }
  if (type.kind() != Kind::kArray || type.component_kind() == Kind::kStructure) return hash;
  const RawBuffer& raw = structure.raw_elements(type.component_kind());
  hash = mixed(hash, raw.size);
  if (type.component_kind() != Kind::kString)
    return mixed(hash, hash_bytes(raw.data, raw.size * element_bytes(type.component_kind())));
  for (const std::string& text : raw.as<std::string>()) hash = mixed(hash, hash_text(text));
  return hash;
}

/// Colours the structures of a graph such that equal colours mean equal content and equal neighbourhoods, to
/// any depth (Weisfeiler-Lehman refinement).
class Refinement {
 public:
  explicit Refinement(const std::vector<FeatureStructure>& structures) : structures_(structures) {
    for (size_t i = 0; i < structures.size(); ++i) position_.emplace(structures[i].id(), i);
    for (const FeatureStructure& each : structures) colors_.push_back(hash_content(each));
    for (size_t i = 0; i < structures.size(); ++i) add_edges(i);
  }

  /// Makes what marks a structure from outside (a view that indexes it) part of its colour.
  void mark(const FeatureStructure& structure, uint64_t mark) {
    uint64_t& color = colors_[position_.at(structure.id())];
    color = mixed(color, mark);
  }

  void run() {
    size_t classes = count_classes();
    for (size_t round = 0; round < structures_.size(); ++round) {
      refine();
      const size_t refined = count_classes();
      if (refined <= classes) return;
      classes = refined;
    }
  }

  uint64_t color(const FeatureStructure& structure) const { return colors_[position_.at(structure.id())]; }

 private:
  struct Edge {
    size_t from, to;
    uint64_t label;
  };

  void add_edges(size_t from) {
    uint64_t element = 0;
    for_each_reference(structures_[from], [&](Feature feature, const FeatureStructure& target) {
      const uint64_t label = feature ? hash_text(feature.name()) : mixed(++element, 0x17);
      edges_.push_back({from, position_.at(target.id()), label});
    });
  }

  void refine() {
    std::vector<uint64_t> forward(colors_), backward(colors_.size(), 0);
    for (const Edge& edge : edges_) {
      forward[edge.from] = mixed(mixed(forward[edge.from], edge.label), colors_[edge.to]);
      backward[edge.to] += mixed(mixed(0x2b, edge.label), colors_[edge.from]);  // a sum: in no order
    }
    for (size_t i = 0; i < colors_.size(); ++i) colors_[i] = mixed(forward[i], backward[i]);
  }

  size_t count_classes() const {
    std::vector<uint64_t> sorted(colors_);
    std::sort(sorted.begin(), sorted.end());
    return static_cast<size_t>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
  }

  const std::vector<FeatureStructure>& structures_;
  std::unordered_map<uint32_t, size_t> position_;
  std::vector<uint64_t> colors_;
  std::vector<Edge> edges_;
};

}  // namespace

void for_each_reference(const FeatureStructure& structure,
                        const std::function<void(Feature, const FeatureStructure&)>& visit) {
  const Type type = structure.type();
  for (const Feature& feature : type.features()) {
    if (is_primitive(feature.range().kind())) continue;
    const FeatureStructure target = structure.get<FeatureStructure>(feature);
    if (target && !target.is_deleted()) visit(feature, target);
  }
  if (type.kind() == Kind::kArray && type.component_kind() == Kind::kStructure)
    for (const FeatureStructure& target : structure.structures())
      if (target && !target.is_deleted()) visit(Feature(), target);
}

std::vector<FeatureStructure> reachable_from(const std::vector<FeatureStructure>& roots) {
  std::vector<FeatureStructure> found;
  std::unordered_set<uint32_t> seen;
  const auto add = [&](const FeatureStructure& each) {
    if (seen.insert(each.id()).second) found.push_back(each);
  };
  for (const FeatureStructure& root : roots) add(root);
  for (size_t next = 0; next < found.size(); ++next) {
    const FeatureStructure current = found[next];
    for_each_reference(current, [&](Feature, const FeatureStructure& target) { add(target); });
  }
  return found;
}

std::vector<CanonicalView> canonical_views(const Cas& cas) {
  std::vector<CanonicalView> views;
  std::vector<FeatureStructure> roots;
  for (const std::string& name : cas.view_names()) {
    const View& view = *cas.find_view(name);
    CanonicalView canonical{name, view.existing_sofa(), {}};
    if (canonical.sofa) roots.push_back(canonical.sofa);
    for (const FeatureStructure& member : view.all()) canonical.members.push_back(member);
    roots.insert(roots.end(), canonical.members.begin(), canonical.members.end());
    views.push_back(std::move(canonical));
  }
  const std::vector<FeatureStructure> structures = reachable_from(roots);
  Refinement refinement(structures);
  for (const CanonicalView& view : views) {
    const uint64_t name = hash_text(view.name);
    if (view.sofa) refinement.mark(view.sofa, mixed(name, 1));
    for (const FeatureStructure& member : view.members) refinement.mark(member, mixed(name, 2));
  }
  refinement.run();
  for (CanonicalView& view : views)
    std::stable_sort(view.members.begin(), view.members.end(),
                     [&](const FeatureStructure& one, const FeatureStructure& two) {
                       const std::string& a = one.type().name();
                       const std::string& b = two.type().name();
                       return a != b ? a < b : refinement.color(one) < refinement.color(two);
                     });
  return views;
}

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
