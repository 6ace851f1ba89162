#pragma once

#include <map>

#include "memory/belief/belief.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/scene_record.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// What recording one scene did.
struct RecordedScene {
  Id scene = 0;
  std::vector<Id> observations;  ///< in the order of the record
  belief::BeliefUpdate update;
};

/// What a scene means for the belief, before anything is written.
struct ResolvedScene {
  belief::Scene scene;  ///< as the belief sees it, observations with the numbers that they will have
  belief::BeliefUpdate update;
  belief::BeliefState after;
};

/// Moves the belief on scene by scene and keeps everything that changes: one scene is one transaction. The
/// belief itself is part of it, so that a Recorder over the same file goes on exactly where the last one was
/// stopped, however that happened.
class Recorder {
 public:
  /// `run` is from Store::begin_run. Takes up the belief that the memory holds. Error when it cannot be read.
  Recorder(Store& store, Id run, const belief::BeliefOptions& options = {});

  /// How evidence is judged from the next scene on.
  void set_options(const belief::BeliefOptions& options) { options_ = options; }

  /// What a scene would change. Error when it lies before the last one.
  ResolvedScene resolve(const SceneRecord& scene) const;
  /// Adds a scene with everything that it changes, `resolved` being what resolve() said. On Error nothing is
  /// added.
  RecordedScene record(const SceneRecord& scene, ResolvedScene resolved);
  /// Both at once, without a copy of the belief.
  RecordedScene record(const SceneRecord& scene);

  const belief::BeliefState& belief() const { return state_; }

 private:
  class Writing;
  void take_up();

  Store& store_;
  Id run_;
  belief::BeliefOptions options_;
  belief::BeliefState state_;
  Id next_observation_ = 1;
  std::map<Id, BeliefRow> told_;  ///< what the memory says about each object of the belief
  Id max_object_ = 0;             ///< of the memory
  BeliefCheckpoint checkpoint_;
  std::map<std::string, double> last_joints_;  ///< of the scene before
  std::map<std::string, Id> places_;           ///< that the memory knows
};

/// What the belief looks at in a record; observations get the numbers from `first_observation` on.
belief::Scene evidence_of(const SceneRecord& record, int64_t first_observation = 0);

/// A recording, known by what is in it: the times, poses and sizes of its frames and some of its images.
struct FrameDigest {
  int64_t index = 0;
  TimeNs time = 0;
};
std::string recording_fingerprint(const std::vector<FrameDigest>& frames, const std::vector<cv::Mat>& images);

}  // namespace loci::memory
