#include <algorithm>

#include "perception/cas/cas.h"

namespace loci::perception::cas {

Selection Selection::sorted_by(std::string_view feature) const {
  const auto key = [&](const FeatureStructure& each) {
    const Value& value = each.value(each.feature(feature));
    if (std::holds_alternative<Reference>(value))
      throw Error("cannot sort by '" + std::string(feature) + "', which holds references");
    return value;
  };
  std::vector<std::pair<Value, FeatureStructure>> keyed;
  for (const FeatureStructure& each : found_) keyed.emplace_back(key(each), each);
  std::stable_sort(keyed.begin(), keyed.end(), [](const auto& one, const auto& two) {
    const Value& a = one.first;
    const Value& b = two.first;
    if (a.index() != b.index()) return a.index() < b.index();
    if (const bool* flag = std::get_if<bool>(&a)) return *flag < std::get<bool>(b);
    if (const int64_t* number = std::get_if<int64_t>(&a)) return *number < std::get<int64_t>(b);
    if (const double* number = std::get_if<double>(&a)) {
      const double other = std::get<double>(b);
      return *number < other || (*number == *number && other != other);  // NaN last
    }
    if (const std::string* text = std::get_if<std::string>(&a)) return *text < std::get<std::string>(b);
    return false;
  });
  std::vector<FeatureStructure> sorted;
  for (auto& [value, each] : keyed) sorted.push_back(each);
  return Selection(std::move(sorted));
}

Selection Selection::filter(const std::function<bool(const FeatureStructure&)>& keep) const {
  std::vector<FeatureStructure> kept;
  std::copy_if(found_.begin(), found_.end(), std::back_inserter(kept), keep);
  return Selection(std::move(kept));
}

FeatureStructure View::sofa() {
  if (sofa_.is_null()) {
    replace_sofa(cas_->create("uima.cas.Sofa"));
    sofa_.set("sofaID", name_);
  }
  return sofa_;
}

void View::adopt_sofa(const FeatureStructure& sofa) {
  if (sofa_) throw Error("view '" + name_ + "' has a sofa already", {}, "read into an empty CAS");
  if (sofa.is_null() || &sofa.cas() != cas_ || !sofa.is_a("uima.cas.Sofa"))
    throw Error("the sofa of view '" + name_ + "' is no uima.cas.Sofa of this CAS");
  replace_sofa(sofa);
}

void View::replace_sofa(const FeatureStructure& sofa) {
  cas_->note_sofa(name_, sofa_);
  sofa_ = sofa;
}

void View::set_sofa_text(std::string text, std::string mime_type) {
  sofa().set("sofaString", text);
  sofa().set("mimeType", mime_type);
}

void View::set_sofa_uri(std::string uri, std::string mime_type) {
  sofa().set("sofaURI", uri);
  sofa().set("mimeType", mime_type);
}

void View::set_sofa_data(const FeatureStructure& data, std::string mime_type) {
  sofa().set("sofaArray", data);
  sofa().set("mimeType", mime_type);
}

FeatureStructure View::sofa_data() const {
  return sofa_.is_null() ? FeatureStructure() : sofa_.get<FeatureStructure>("sofaArray");
}

std::string View::mime_type() const {
  return sofa_.is_null() ? "" : sofa_.get<std::string>("mimeType");
}

void View::add_to_index(const FeatureStructure& structure) {
  if (structure.is_null() || &structure.cas() != cas_)
    throw Error("only feature structures of the same CAS can be indexed in view '" + name_ + "'");
  const Type type = structure.type();
  if (!members_.insert(structure.id()).second) return;
  cas_->note_index(name_, {next_sequence_, structure.id()}, true);
  index_[type.order()].push_back({next_sequence_++, structure.id()});
}

void View::remove_from_index(const FeatureStructure& structure) {
  if (members_.erase(structure.id()) == 0) return;
  const auto entries = index_.find(structure.type().order());
  std::erase_if(entries->second, [&](const IndexEntry& entry) {
    if (entry.id == structure.id()) cas_->note_index(name_, entry, false);
    return entry.id == structure.id();
  });
}

bool View::is_indexed(const FeatureStructure& structure) const {
  return members_.contains(structure.id());
}

Selection View::select(Type type) const {
  std::vector<IndexEntry> entries;
  const auto end = index_.upper_bound(type.last_order());
  for (auto each = index_.lower_bound(type.order()); each != end; ++each)
    entries.insert(entries.end(), each->second.begin(), each->second.end());
  std::sort(entries.begin(), entries.end(),
            [](const IndexEntry& one, const IndexEntry& two) { return one.sequence < two.sequence; });
  std::vector<FeatureStructure> found;
  found.reserve(entries.size());
  for (const IndexEntry& entry : entries)
    if (!cas_->is_hidden(entry.id)) found.emplace_back(cas_, entry.id);
  return Selection(std::move(found));
}

Selection View::select(std::string_view type_name) const {
  return select(cas_->type_system().type(type_name));
}

Selection View::all() const {
  return select(cas_->type_system().top());
}

}  // namespace loci::perception::cas
