#include "perception/cas/cas.h"

#include <algorithm>
#include <iterator>
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

std::unique_ptr<Cas> Cas::branch() const {
  auto copy = std::make_unique<Cas>(type_system_);
  copy->heap_ = heap_;
  copy->hidden_ = hidden_;
  for (const auto& [name, view] : views_) {
    auto twin = std::make_unique<View>(*copy, name);
    twin->index_ = view->index_;
    twin->members_ = view->members_;
    twin->next_sequence_ = view->next_sequence_;
    twin->sofa_ = FeatureStructure(copy.get(), view->sofa_.id());
    copy->views_.emplace(name, std::move(twin));
  }
  copy->begin_changes();
  return copy;
}

void Cas::begin_changes() {
  journals_.emplace_back();
  journals_.back().size = heap_.size();
}

void Cas::remember(uint32_t id, const Record& record) {
  Journal& journal = journals_.back();
  if (id <= journal.size) journal.before.try_emplace(id, record);
}

void Cas::note_index(const std::string& view, const IndexEntry& entry, bool added) {
  if (!journals_.empty()) journals_.back().index.push_back({view, entry, added});
}

void Cas::note_sofa(const std::string& view, const FeatureStructure& before) {
  if (!journals_.empty()) journals_.back().sofas.try_emplace(view, before);
}

void Cas::keep_changes() {
  Journal done = std::move(journals_.back());
  journals_.pop_back();
  if (journals_.empty()) return;
  Journal& outer = journals_.back();
  for (auto& [id, record] : done.before)
    if (id <= outer.size) outer.before.try_emplace(id, std::move(record));
  std::move(done.index.begin(), done.index.end(), std::back_inserter(outer.index));
  outer.sofas.merge(done.sofas);
  std::move(done.views.begin(), done.views.end(), std::back_inserter(outer.views));
}

void Cas::undo_changes() {
  Journal done = std::move(journals_.back());
  journals_.pop_back();
  for (auto change = done.index.rbegin(); change != done.index.rend(); ++change) {
    View& view = *find_view(change->view);
    const uint32_t id = change->entry.id;
    // The type as it was: a structure that was deleted since has lost it, one that is new still has it.
    std::vector<IndexEntry>& entries = view.index_[heap_[id - 1].type.order()];
    if (change->added) {
      view.members_.erase(id);
      std::erase_if(entries, [&](const IndexEntry& entry) { return entry.id == id; });
    } else {
      view.members_.insert(id);
      entries.push_back(change->entry);
    }
  }
  for (const auto& [name, sofa] : done.sofas) find_view(name)->sofa_ = sofa;
  for (const std::string& name : done.views) views_.erase(name);
  for (auto& [id, record] : done.before) heap_[id - 1] = std::move(record);
  heap_.erase(heap_.begin() + static_cast<std::ptrdiff_t>(done.size), heap_.end());
}

std::vector<FeatureStructure> Cas::changes() const {
  std::vector<FeatureStructure> found;
  if (journals_.empty()) return found;
  auto* self = const_cast<Cas*>(this);  // Handles can write; whoever may not, has a const Cas elsewhere too.
  const auto add = [&](size_t id) {
    if (!heap_[id - 1].deleted) found.emplace_back(self, static_cast<uint32_t>(id));
  };
  for (const auto& [id, record] : journals_.back().before) add(id);
  for (size_t id = journals_.back().size + 1; id <= heap_.size(); ++id) add(id);
  return found;
}

std::vector<std::string> Cas::changed_views() const {
  std::vector<std::string> names;
  if (!journals_.empty())
    for (const auto& [name, sofa] : journals_.back().sofas) names.push_back(name);
  return names;
}

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
