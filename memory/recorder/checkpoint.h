#pragma once

#include <map>

#include "memory/belief/state.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// The belief after the last scene of a memory; empty for a new memory, or if another program wrote that
/// scene.
belief::BeliefState load_belief(const Store& store);

/// Stores the belief with each scene: one checkpoint for the common part, and one per object, of which only
/// those that changed are written.
class BeliefCheckpoint {
 public:
  /// Unchanged objects are recognised by the bytes written last, which are those of the last committed()
  /// scene.
  void save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state);
  void committed();
  /// Writes all objects with the next scene.
  void reset();

 private:
  std::map<int64_t, std::string> stored_, fresh_;  ///< bytes by key of the object
  std::vector<int64_t> removed_;
  bool all_ = true;
};

/// Deletes what `request` names from the memory and from the checkpoint. Error for an unknown object.
ForgetResult forget(Store& store, const ForgetRequest& request, Id run);

}  // namespace loci::memory
