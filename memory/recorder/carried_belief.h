#pragma once

#include <map>

#include "memory/belief/state.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// The belief that a memory holds after its last scene; empty for a new memory.
belief::BeliefState load_belief(const Store& store);

/// Keeps the belief as it is after each scene in the place of the one before: one checkpoint for what is
/// common, one per object, of which only those that changed are written.
class CarriedBelief {
 public:
  /// What changed is known by the bytes written last; it is only taken note of with committed().
  void save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state);
  void committed();
  /// Forget what was written last: everything is written with the next scene.
  void start_anew();

 private:
  std::map<int64_t, std::string> kept_, fresh_;  ///< bytes by key of the object
  std::vector<int64_t> removed_;
  bool all_ = true;
};

}  // namespace loci::memory
