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

/// Erases what a request names from a memory, its belief and its reasoning, by rewrite_memory(): in its
/// place, or at `output` where one is given. Error for an unknown object.
ForgetResult forget(const std::filesystem::path& memory, const ForgetRequest& request,
                    const std::filesystem::path& output = {});

}  // namespace loci::memory
