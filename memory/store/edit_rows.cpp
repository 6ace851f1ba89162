#include "memory/store/edit_rows.h"

#include "memory/store/reading.h"

namespace loci::memory {
namespace {

template <class Row, class Read>
std::vector<Row> rows_of(Store::Implementation& store, const char* table, Id run, Read read) {
  return all<Row>(store, fmt::format("SELECT * FROM {} WHERE run = ? ORDER BY id", table), {sql(run)}, read);
}

}  // namespace

EditRows::EditRows(const Store& store) : implementation_(std::make_unique<Store::Implementation>()) {
  implementation_->path = store.path();
  implementation_->guarded([&] {
    implementation_->database =
        std::make_unique<SQLite::Database>(store.path().string(), SQLite::OPEN_READONLY);
  });
}

EditRows::~EditRows() = default;

std::vector<AssociationRow> EditRows::associations_of(Id run) const {
  return rows_of<AssociationRow>(*implementation_, "association", run, association_row);
}
std::vector<EventRow> EditRows::events_of(Id run) const {
  return rows_of<EventRow>(*implementation_, "event", run, event_row);
}
std::vector<BeliefRow> EditRows::beliefs_of(Id run) const {
  return rows_of<BeliefRow>(*implementation_, "belief", run, belief_row);
}
std::vector<FactRow> EditRows::facts_of(Id run) const {
  return rows_of<FactRow>(*implementation_, "fact", run, fact_row);
}

AssociationRow EditRows::association(Id id) const {
  return one<AssociationRow>(*implementation_, "association", id, association_row);
}
EventRow EditRows::event(Id id) const {
  return one<EventRow>(*implementation_, "event", id, event_row);
}
BeliefRow EditRows::belief(Id id) const {
  return one<BeliefRow>(*implementation_, "belief", id, belief_row);
}
FactRow EditRows::fact(Id id) const {
  return one<FactRow>(*implementation_, "fact", id, fact_row);
}

Id EditRows::known_instead(const char* table, Id id) const {
  const std::string next =
      fmt::format("SELECT id FROM {} WHERE supersedes = ? ORDER BY known_from, id LIMIT 1", table);
  return implementation_->guarded([&] {
    for (bool found = true; found;) {
      found = false;
      Id later = id;
      implementation_->query(next, {sql(id)}, [&](const SqlRow& row) {
        later = row.integer("id");
        found = true;
      });
      id = later;
    }
    return id;
  });
}

}  // namespace loci::memory
