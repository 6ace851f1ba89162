#pragma once

#include <memory>

#include "memory/store/store.h"

namespace loci::memory {

/// What corrections need to be turned around: rows of a run, and rows by their number, whether they are known
/// any more or not. Reads beside the store with a connection of its own, what was committed before.
class EditRows {
 public:
  explicit EditRows(const Store& store);
  ~EditRows();

  std::vector<AssociationRow> associations_of(Id run) const;
  std::vector<EventRow> events_of(Id run) const;
  std::vector<BeliefRow> beliefs_of(Id run) const;
  std::vector<FactRow> facts_of(Id run) const;
  AssociationRow association(Id id) const;
  EventRow event(Id id) const;
  BeliefRow belief(Id id) const;
  FactRow fact(Id id) const;
  /// The row that stands at the end of what superseded a row, what superseded that, and so on: the one that
  /// is known. `table`: association, event, belief, fact.
  Id known_instead(const char* table, Id id) const;

 private:
  std::unique_ptr<Store::Implementation> implementation_;
};

}  // namespace loci::memory
