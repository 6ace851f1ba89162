#pragma once

// Of this room alone: how rows are read as of two clocks.

#include <fmt/format.h>

#include "memory/store/database.h"

namespace loci::memory {

/// "known_to IS NULL", or what was known at ?N.
std::string known_condition(const AsOf& as_of, std::vector<SqlValue>& values);
/// Rows that have begun at `at`; with `open`, those that have not ended either.
std::string valid_condition(const AsOf& as_of, std::vector<SqlValue>& values, bool open);
/// " AND column >= ?N AND column <= ?M".
std::string range_condition(const char* column, std::optional<TimeNs> from, std::optional<TimeNs> to,
                            std::vector<SqlValue>& values);

RecordingRow recording_row(const SqlRow& row);
PlaceRow place_row(const SqlRow& row);
SceneRow scene_row(const SqlRow& row);
ObservationRow observation_row(const SqlRow& row);
AssociationRow association_row(const SqlRow& row);
EventRow event_row(const SqlRow& row);
FactRow fact_row(const SqlRow& row);
BeliefRow belief_row(const SqlRow& row);
VisibilityRow visibility_row(const SqlRow& row);

/// Whether a sighting may not be known any more, or not yet.
bool asks_what_was_known(Store::Implementation& store, const AsOf& as_of);

template <class Row, class Read>
std::vector<Row> all(Store::Implementation& store, const std::string& text,
                     const std::vector<SqlValue>& values, Read read) {
  return store.guarded([&] {
    std::vector<Row> rows;
    store.query(text, values, [&](const SqlRow& row) { rows.push_back(read(row)); });
    return rows;
  });
}

template <class Row, class Read>
Row one(Store::Implementation& store, const char* table, Id id, Read read) {
  auto rows = all<Row>(store, fmt::format("SELECT * FROM {} WHERE id = ?", table), {sql(id)}, read);
  if (rows.empty()) throw Error(fmt::format("no {} {}", table, id), {store.path.string(), 0, {}});
  return std::move(rows[0]);
}

}  // namespace loci::memory
