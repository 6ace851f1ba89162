#pragma once

// Of this room alone: edits as runs.

#include "mapping/base/json.h"
#include "memory/edits/edits.h"
#include "memory/questions/part_names.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// Begins a run of an edit, and ends it. What it did stands in its configuration: "text", and what is needed
/// to turn it around.
class EditRun {
 public:
  EditRun(Store& store, const Json& configuration);
  ~EditRun() { store_.finish_run(id_); }
  EditRun(const EditRun&) = delete;
  EditRun& operator=(const EditRun&) = delete;
  Id id() const { return id_; }

 private:
  Store& store_;
  Id id_;
};

/// The edit that a run made.
Edit edit_of(const Store& store, Id run);

/// A row of source "user" that takes the place of `row`.
template <class Row>
Row correction_of(const Row& row) {
  Row corrected = row;
  corrected.clock.supersedes = row.id;
  corrected.clock.source = "user";
  corrected.clock.known_to.reset();
  return corrected;
}

/// Turns around what a run did, as a new run: rows that superseded others give way to them, others are taken
/// back. Returns the new run.
Id reverse_run(Store& store, const RunRow& run, const std::string& text, const Json& more);

/// Adds an annotation with the label of an observation.
void add_label(Store& store, Id run, Id scene, Id observation, const std::string& label);
/// Adds a map like one of the memory with a remark in its text, so that it is the newest.
Id add_corrected_map(Store& store, const MapRow& like, const std::string& urdf, const std::string& remark);

}  // namespace loci::memory
