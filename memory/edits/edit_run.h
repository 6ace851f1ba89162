#pragma once

// Private to this module: what all edits have in common.

#include "mapping/base/text/json_fwd.h"
#include "memory/edits/edits.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// A run of an edit. Its configuration has the "text" of the edit, and what is needed to reverse it. All that
/// is done until it is finished is one transaction: an edit that fails leaves the memory as it was.
class EditRun {
 public:
  EditRun(Store& store, const Json& configuration);
  EditRun(const EditRun&) = delete;
  EditRun& operator=(const EditRun&) = delete;
  Id id() const { return id_; }
  Edit finish();

 private:
  Store& store_;
  ChangeTransaction change_;
  Id id_;
};

/// The edit that a run made.
Edit edit_of(const Store& store, Id run);

/// What edits say of identities, later ones over earlier ones.
KnownIdentities known_identities(const Store& store, const std::vector<Edit>& list);

[[noreturn]] void refuse(const Store& store, const std::string& what, const std::string& hint);

/// A row of source "user" that takes the place of `row`.
template <class Row>
Row correction_of(const Row& row) {
  Row corrected = row;
  corrected.clock.supersedes = row.id;
  corrected.clock.source = "user";
  corrected.clock.known_to.reset();
  return corrected;
}

}  // namespace loci::memory
