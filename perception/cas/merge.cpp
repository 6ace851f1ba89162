#include <algorithm>

#include "perception/cas/cas.h"

namespace loci::perception::cas {

/// Brings the changes of a branch home, each compared with what there was when the branch was made.
class Cas::Merge {
 public:
  Merge(Cas& home, const Cas& branch)
      : home_(home),
        branch_(branch),
        journal_(branch.journals_.at(0)),
        shift_(static_cast<uint32_t>(home.heap_.size() - journal_.size)) {}

  void run() {
    for (size_t id = journal_.size + 1; id <= branch_.heap_.size(); ++id) add(branch_.heap_[id - 1]);
    for (const auto& [id, before] : journal_.before) change(id, before, branch_.heap_[id - 1]);
    for (const std::string& name : branch_.view_names()) home_.view(name);
    for (const auto& [name, before] : journal_.sofas)
      if (View* view = home_.find_view(name)) view->replace_sofa(ours(branch_.find_view(name)->sofa_.id()));
    for (const IndexChange& change : journal_.index) index(change);
  }

 private:
  uint32_t at_home(uint32_t id) const { return id > journal_.size ? id + shift_ : id; }
  FeatureStructure ours(uint32_t id) const { return {&home_, at_home(id)}; }
  Value at_home(const Value& value) const {
    const Reference* reference = std::get_if<Reference>(&value);
    return reference == nullptr ? value : Value(Reference{at_home(reference->id)});
  }

  void add(const Record& made) {
    Record copy = made;
    for (Value& value : copy.values) value = at_home(value);
    for (uint32_t& element : copy.elements) element = at_home(element);
    home_.heap_.push_back(std::move(copy));
  }

  void change(uint32_t id, const Record& before, const Record& now) {
    if (home_.heap_[id - 1].deleted) return;
    if (now.deleted) {
      home_.remove({&home_, id});
      return;
    }
    for (size_t i = 0; i < now.values.size(); ++i)
      if (now.values[i] != before.values[i]) change_value(id, i, before.values[i], now.values[i]);
    if (now.elements != before.elements) change_elements(id, before.elements, now.elements);
    if (now.buffer.data != before.buffer.data) home_.writable(id).buffer = now.buffer;
  }

  void change_value(uint32_t id, size_t feature, const Value& before, const Value& now) {
    const Value here = home_.record(id).values[feature];
    const Reference* list = std::get_if<Reference>(&here);
    const Reference* more = std::get_if<Reference>(&now);
    const bool both = here != before && list != nullptr && more != nullptr;
    if (both && append(list->id, at_home(more->id))) return;
    home_.writable(id).values[feature] = at_home(now);
  }

  /// Both made a list where there was none, or went on with the same linked list: `more` comes last. False
  /// when it is no list.
  bool append(uint32_t list, uint32_t more) {
    const Type type = home_.record(list).type;
    if (type == home_.type_system_->array_type(Kind::kStructure)) {
      if (home_.record(more).type != type) return false;
      const std::vector<uint32_t> elements = home_.record(more).elements;
      std::vector<uint32_t>& all = home_.writable(list).elements;
      all.insert(all.end(), elements.begin(), elements.end());
      return true;
    }
    const auto tail = type.find_feature("tail");
    if (!tail || !home_.type_system_->list_component(type)) return false;
    FeatureStructure last(&home_, list);
    for (auto next = last; next && next.type() == type; next = next.get<FeatureStructure>(*tail)) last = next;
    last.set(*tail, FeatureStructure(&home_, more));
    return true;
  }

  void change_elements(uint32_t id, const std::vector<uint32_t>& before, const std::vector<uint32_t>& now) {
    const auto contains = [](const std::vector<uint32_t>& all, uint32_t each) {
      return std::find(all.begin(), all.end(), each) != all.end();
    };
    std::vector<uint32_t>& here = home_.writable(id).elements;
    const bool only_there = here == before;
    std::vector<uint32_t> merged;
    for (const uint32_t each : only_there ? now : here)
      if (only_there)
        merged.push_back(at_home(each));
      else if (!contains(before, each) || contains(now, each))
        merged.push_back(each);
    if (!only_there)
      for (const uint32_t each : now)
        if (!contains(before, each)) merged.push_back(at_home(each));
    here = std::move(merged);
  }

  void index(const IndexChange& change) {
    View& view = home_.view(change.view);
    const FeatureStructure structure = ours(change.entry.id);
    if (structure.is_deleted()) return;
    if (change.added)
      view.add_to_index(structure);
    else
      view.remove_from_index(structure);
  }

  Cas& home_;
  const Cas& branch_;
  const Journal& journal_;
  uint32_t shift_;
};

void Cas::merge(const Cas& branch) {
  Merge(*this, branch).run();
}

}  // namespace loci::perception::cas
