#pragma once

#include <string>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/belief/state.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// What people's corrections say: the object that an observation is of.
using KnownIdentities = std::map<Id, Id>;

/// What a run states of identities, in its configuration.
Json identity_json(const std::map<Id, std::vector<Id>>& observations_of);
void read_identities(const Json& configuration, KnownIdentities& known);

/// How the belief is revised.
struct Revision {
  /// Scenes from this one on are reasoned about anew, earlier ones are followed as they were decided; 0 = all
  /// are followed.
  Id from = 0;
  /// The stored belief, or `before` where that is set, is that after this scene: earlier ones need not be
  /// followed. 0 = from the beginning.
  Id resume_after = 0;
  KnownIdentities known = {};
  std::map<Id, double> probabilities = {};  ///< of those identities that are supposed, by observation
  const belief::BeliefState* before = nullptr;
  std::string source = "edit";  ///< of the rows
  /// The stored reasoning of these scenes is replaced, too. It has no versions: not where the revision can be
  /// undone.
  bool replace_reasoning = false;
};

/// Computes the belief again with what is known of identities, and with what later scenes tell of earlier
/// ones (belief::hindsight(), where at most kLookBack scenes are reasoned about anew), and adds the rows that
/// differ from those known now, each in place of one that it supersedes or retracts. The belief after the
/// last scene becomes the new checkpoint. Objects keep their numbers as long as they keep the observation
/// that they were founded on. Scenes that were forgotten are passed over. The derived tables are left to
/// Store::derive(). Error when another scene has no evidence (Store::scenes_without_reasoning()).
void revise(const Store& store, SceneTransaction& transaction, const Revision& revision, Progress& progress);

constexpr const char* kHindsight = "hindsight";  ///< source of the rows that looking back made
constexpr size_t kLookBack = 500;                ///< scenes

/// Corrects what the scenes that are pending (Recorder::begin_review()) decided and later ones of them
/// contradict, as part of `run`; nothing where there are more than kLookBack. They are not pending then. The
/// number of observations that were taken for another object.
size_t look_back(Store& store, Id run, Progress& progress);

/// A row that supersedes another and is never known: it retracts that one.
template <class Row>
Row retraction_of(Row row, TimeNs known) {
  row.clock.supersedes = row.id;
  row.clock.known_to = known;
  return row;
}

}  // namespace loci::memory
