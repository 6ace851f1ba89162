#pragma once

#include <map>

#include "memory/belief/belief.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/scene_record.h"
#include "memory/store/place_motion.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// Result of recording one scene.
struct RecordedScene {
  Id scene = 0;
  std::vector<Id> observations;  ///< in the order of the record
  belief::BeliefUpdate update;
};

/// Effect of a scene on the belief, before anything is written.
struct ResolvedScene {
  belief::Scene scene;  ///< input of the belief, observations with their future numbers
  belief::BeliefUpdate update;
  belief::BeliefState after;
};

/// Updates the belief scene by scene and stores all changes, one transaction per scene. Each transaction has
/// a checkpoint of the belief, so that a Recorder over the same file resumes exactly where the last one
/// stopped, however that happened.
class Recorder {
 public:
  /// `run` is from Store::begin_run. Error when the stored belief cannot be read.
  Recorder(Store& store, Id run, const belief::BeliefOptions& options = {});

  /// Options from the next scene on.
  void set_options(const belief::BeliefOptions& options) {
    options_ = options;
    checkpoint_.set_options(options);
  }

  /// The effect of a scene. Error when it lies before the last one.
  ResolvedScene resolve(const SceneRecord& scene) const;
  /// Writes a scene and its effect as given by resolve(). Nothing is written on Error.
  RecordedScene record(const SceneRecord& scene, ResolvedScene resolved);
  /// Both at once, without a copy of the belief.
  RecordedScene record(const SceneRecord& scene);

  const belief::BeliefState& belief() const { return state_; }
  /// From here on scenes are pending for look_back().
  void begin_review() { review_ = true; }

 private:
  class SceneWriter;
  void load();
  belief::Scene evidence(const SceneRecord& record) const;
  /// Of the room in a scene: one perceived without a map leaves the room as it was.
  std::optional<Id> map_of(const SceneRow& row) const { return row.map ? row.map : last_map_; }

  Store& store_;
  Id run_;
  belief::BeliefOptions options_;
  belief::BeliefState state_;
  Id next_observation_ = 1;
  std::map<Id, BeliefRow> stored_beliefs_;  ///< last row of each believed object
  Id max_object_ = 0;                       ///< of the memory
  BeliefCheckpoint checkpoint_;
  bool review_ = false;                         ///< scenes are pending for look_back()
  std::map<std::string, double> last_joints_;   ///< as they were seen last, of those seen in this run
  std::optional<Id> last_map_;                  ///< of the room in the scene before
  std::vector<belief::PlacePose> last_places_;  ///< in the scene before
  std::map<std::string, PlaceRow> places_;      ///< of the memory
  mutable PlaceMotions motions_;
};

/// Input of the belief in a record; observations are numbered from `first_observation` on.
belief::Scene evidence_of(const SceneRecord& record, int64_t first_observation = 0);

struct FrameDigest {
  int64_t index = 0;
  TimeNs time = 0;
};
/// Identifies a recording by its content: indices and times of its frames, and some of its images.
std::string recording_fingerprint(const std::vector<FrameDigest>& frames, const std::vector<cv::Mat>& images);

}  // namespace loci::memory
