#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/belief/calibration.h"
#include "memory/belief/habits.h"
#include "memory/belief/observation.h"
#include "memory/belief/options.h"

namespace loci::memory::belief {

enum class Status {
  tentative,  ///< seen too rarely to be told from a false cluster; nobody is told
  present,    ///< believed to be where it was seen last (perhaps hidden or out of view)
  gone,       ///< looked for and not there
};

/// One way an object looked, and how often it looked like that.
struct Look {
  std::vector<Descriptor> descriptors;
  double weight = 1;
  TimeNs time = 0;
  bool partial = false;

  template <class Archive>
  void archive(Archive& fields) {
    fields(descriptors, weight, time, partial);
  }
};

/// An observation that was attributed to a tentative object, to be told when it is confirmed.
struct PendingSighting {
  int64_t observation = 0;  ///< memory's number
  TimeNs time = 0;
  bool first = false;      ///< it made the object; otherwise it was found again
  double probability = 0;  ///< of the attribution

  template <class Archive>
  void archive(Archive& fields) {
    fields(observation, time, first, probability);
  }
};

/// What a track may be instead of what it is taken for: alike things that changed places cannot be told
/// apart.
struct Alternative {
  int64_t key = 0;  ///< of the proto object that it may be in truth
  double probability = 0;

  template <class Archive>
  void archive(Archive& fields) {
    fields(key, probability);
  }
};

/// A proto object: what a bag of observations adds up to (§3.2.5).
struct ProtoObject {
  int64_t key = 0;  ///< within the belief; never reused
  int64_t id = 0;   ///< the memory's object number; 0 while tentative
  Status status = Status::tentative;
  TimeNs first_seen = 0;
  TimeNs last_seen = 0;
  TimeNs last_update = 0;       ///< of the scene that last told anything about it
  double attention_s = 0;       ///< BeliefState::attention_s then: the clock for which probability_here holds
  double seen_attention_s = 0;  ///< the same clock when it was seen last
  int sightings = 0;
  double exists_log_odds = 0;   ///< of being an object and no false cluster
  double probability_here = 1;  ///< that it still is where it was seen last
  int hidden_looks = 0;         ///< scenes in a row in which something stood in front of it
  bool told_hidden = false;     ///< an event said so and no sighting has followed

  std::string place;     ///< what it stands on; empty = unknown
  AxisBox box;           ///< fused; centre in the place's frame, size along the map's axes
  double variance = 0;   ///< of the centre per axis, m²
  bool partial = false;  ///< never seen whole since it is there
  bool sized = true;     ///< somebody measured its size
  Isometry3d map_from_camera = Isometry3d::Identity();  ///< of the last sighting

  std::vector<Look> looks;
  std::string kind;  ///< what classifiers call it most of all; empty = nobody said
  Factor handling;   ///< how often it was handled, against what its kind and place let expect
  std::vector<Alternative> alternatives;  ///< most probable first; the rest is that it is itself
  int64_t last_observation = 0;           ///< memory's number
  std::vector<PendingSighting> pending;   ///< while tentative
  /// Key of an object that is taken for having moved away from here: this is that object if it was another
  /// one that was seen elsewhere. 0 = none of this kind. Tentative until somebody looks here again.
  int64_t leftover_of = 0;
  /// Probability of being a false cluster when it turned up where nothing new was expected; 0 = it did not,
  /// or the next look has shown.
  double doubt = 0;

  double probability_itself() const;

  template <class Archive>
  void archive(Archive& fields) {
    archive_before_4(fields);
    fields(leftover_of, doubt);
  }
  /// The fields that beliefs before the fourth version had.
  template <class Archive>
  void archive_before_4(Archive& fields) {
    fields(key, id, status, first_seen, last_seen, last_update, attention_s, seen_attention_s, sightings,
           exists_log_odds, probability_here, hidden_looks, told_hidden, place, box.centre, box.size,
           variance, partial, sized, map_from_camera, looks, kind, handling, alternatives, last_observation,
           pending);
  }
};

/// All that the belief carries from one scene to the next.
struct BeliefState {
  std::vector<ProtoObject> objects;  ///< in the order in which they were first seen
  std::optional<TimeNs> last_scene;
  double attention_s =
      0;  ///< seconds during which things could be handled; time that was watched counts less
  int64_t next_key = 1;
  int64_t next_id = 1;
  Habits habits;
  Calibration calibration;  ///< what likeness tells
  Factor view_noise;        ///< variance of where things seem to stand from elsewhere, against the options'

  const ProtoObject* find(int64_t id) const;

  template <class Archive>
  void archive(Archive& fields) {
    fields(objects);
    archive_rest(fields);
  }
  /// All but the objects, which checkpoints keep one by one.
  template <class Archive>
  void archive_rest(Archive& fields) {
    fields(last_scene, attention_s, next_key, next_id, habits, view_noise, calibration);
  }
  /// The fields that the versions from the second to the fourth had.
  template <class Archive>
  void archive_rest_before_5(Archive& fields, int version) {
    fields(last_scene, attention_s, next_key, next_id);
    version < 4 ? habits.archive_before_4(fields) : habits.archive(fields);
    if (version >= 3) fields(view_noise);
  }
};

/// What the belief learned to multiply view_change_variance() by: whether poses are better than the options
/// say shows in what stays. Never below a tenth: visible parts differ.
double view_noise(const BeliefState& state);
/// Whose habits tell about an object.
Handled handled(const ProtoObject& object);
/// Probability that an object was handled between its last update and a time (BeliefState::attention_s).
double handled_until(const ProtoObject& object, double attention_s, const BeliefState& state,
                     const BeliefOptions& options);
/// Probability that an object still is where it was seen last, as of the last scene.
double probability_here(const ProtoObject& object, const BeliefState& state, const BeliefOptions& options);

/// All of it as bytes; every number comes back as it was.
std::string to_bytes(const BeliefState& state);
/// Also reads beliefs of earlier versions. Error when the bytes are no belief.
BeliefState belief_state_from_bytes(const std::string& bytes);

}  // namespace loci::memory::belief
