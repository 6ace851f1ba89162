#pragma once

#include <map>

#include "memory/belief/options.h"
#include "memory/belief/state.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// The belief after the last scene of a memory; empty for a new memory, or if another program wrote that
/// scene.
belief::BeliefState load_belief(const Store& store);

/// Why a memory can be read, but not continued; unset when it can be.
std::optional<Error> unreadable_belief(const Store& store);

/// The options with which the belief of a memory was computed last; the defaults where they were not stored.
belief::BeliefOptions load_options(const Store& store);

inline constexpr const char* kKeptBeliefs = "before/";  ///< prefix of the names of their checkpoints
/// Keeps the belief as it is before a correction, by the correction's run, so that undo brings it back.
void keep_belief(SceneTransaction& transaction, const Store& store, Id run);
/// Makes the belief what it was before that run. The last scene that it knew; unset = it was not kept.
std::optional<Id> restore_belief(SceneTransaction& transaction, const Store& store, Id run);
void drop_kept_belief(SceneTransaction& transaction, Id run);
/// Scenes that look_back() still has to go over: what was believed before them, and whether one of them
/// contradicts what others decided (BeliefUpdate::mistakes).
struct PendingReview {
  belief::BeliefState before;
  Id after = 0;  ///< the scene that `before` is the belief after; 0 = none
  bool contradicted = false;
};
/// From here on scenes are pending: keeps the belief as it is, unless some are pending already.
void begin_review(SceneTransaction& transaction, const Store& store);
void note_contradiction(SceneTransaction& transaction);
std::optional<PendingReview> load_review(const Store& store);
void end_review(SceneTransaction& transaction);
/// What ForgetResult::erased calls it.
inline constexpr const char* kUnreadableBelief = "belief that another version of loci wrote";
/// Removes what a belief of another version of loci holds, which cannot be rewritten. That it was of another
/// version remains, so that no program goes on as if nothing were known. Whether there was anything to
/// remove.
bool drop_unreadable_belief(SceneTransaction& transaction, const Store& store);
/// The belief after a scene, where the checkpoint is of that.
belief::BeliefState load_belief(const Store& store, Id scene);

/// Stores the belief with each scene: one checkpoint for the common part, and one per object and per texture
/// of it, of which only those that changed are written.
class BeliefCheckpoint {
 public:
  explicit BeliefCheckpoint(const belief::BeliefOptions& options = {}) : options_(options) {}
  void set_options(const belief::BeliefOptions& options);
  /// Unchanged objects are recognised by the bytes written last, which are those of the last committed()
  /// scene.
  void save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state);
  void committed();
  /// Writes all objects with the next scene.
  void reset();

 private:
  std::map<std::string, std::string> stored_, fresh_;  ///< bytes by name; those of textures are not kept
  std::vector<std::string> removed_;
  bool all_ = true, options_saved_ = false;
  belief::BeliefOptions options_;
};

/// Erases what a request names from a memory, its belief and its reasoning, as `run`.
ForgetResult forget(Store& store, const ForgetRequest& request, Id run);

}  // namespace loci::memory
