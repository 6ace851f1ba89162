#include <algorithm>
#include <iterator>
#include <utility>

#include "perception/cas/cas.h"

namespace loci::perception::cas {
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

}  // namespace loci::perception::cas
