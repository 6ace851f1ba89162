#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/belief/evidence/calibration.h"
#include "memory/belief/evidence/noise_scale.h"
#include "memory/belief/evidence/surface.h"
#include "memory/belief/interaction_model.h"
#include "memory/belief/options.h"
#include "memory/belief/parameters.h"
#include "memory/belief/place_history.h"
#include "memory/belief/scene.h"

namespace loci::memory::belief {

enum class Status {
  tentative,  ///< observed too rarely to exclude clutter; not reported
  present,    ///< believed to be where it was observed last (perhaps hidden or out of view)
  gone,       ///< its spot was observed and it was not there
};

/// An appearance of an object, and how often it was observed.
struct StoredView {
  std::vector<Descriptor> descriptors;
  double weight = 1;
  TimeNs time = 0;
  bool partial = false;
};

/// The texture of one side of an object.
struct TextureView {
  Texture texture;                              ///< positions in the frame of the place
  std::string place;                            ///< empty = the map
  TimeNs time = 0;                              ///< of its scene; no two views of an object have the same
  Vector3d towards_camera = Vector3d::UnitZ();  ///< direction from the object, map frame
  double range = 1;                             ///< as of the observation
  bool in_place = true;                         ///< the object has not moved since
};

/// Observation attributed to a tentative object, reported once that is confirmed.
struct PendingObservation {
  int64_t observation = 0;  ///< memory's number
  TimeNs time = 0;
  bool first = false;      ///< it created the object
  double probability = 0;  ///< of the attribution
};

/// Another object that a track may be: similar objects that changed places are indistinguishable.
struct Alternative {
  int64_t key = 0;  ///< of that proto object
  double probability = 0;
};

/// A proto object: what observations add up to (§3.2.5).
struct ProtoObject {
  int64_t key = 0;  ///< within the belief; never reused
  int64_t id = 0;   ///< the memory's object number; 0 while tentative
  Status status = Status::tentative;
  TimeNs first_seen = 0;
  TimeNs last_seen = 0;
  TimeNs last_update = 0;           ///< of the scene that last carried information about it
  double exposure_s = 0;            ///< BeliefState::exposure_s then; probability_here is as of that
  double last_seen_exposure_s = 0;  ///< BeliefState::exposure_s when it was observed last
  double gone_by_s = 0;             ///< of a gone object: BeliefState::exposure_s of the view that showed it
  double uses = 0;  ///< times that its place was opened, shut or moved since, by what lies there
  int observation_count = 0;
  double exists_log_odds = 0;    ///< of being an object and not clutter
  double probability_here = 1;   ///< of still being where it was observed last
  double missed_views = 0;       ///< scenes since the last observation in which it should have been detected
  int hidden_scenes = 0;         ///< consecutive scenes in which it was occluded
  bool hidden_reported = false;  ///< by an event, and not observed since

  std::string place;     ///< supporting place; empty = unknown
  AxisBox box;           ///< fused; centre in the place's frame, size along the map's axes
  double variance = 0;   ///< of the centre per axis, m²
  bool partial = false;  ///< never observed whole at its present spot
  bool has_size = true;  ///< its size was measured
  Isometry3d map_from_camera = Isometry3d::Identity();  ///< of the last observation

  std::vector<StoredView> views;
  std::vector<TextureView> textures;  ///< oldest first
  Surface surface;  ///< where it was last seen at its present spot, in the place's frame; may be empty
  Isometry3d surface_camera = Isometry3d::Identity();  ///< map_from_camera of the last view of it
  std::string class_name;                              ///< most probable one; empty = not classified
  RateFactor interaction;                              ///< rate of handling relative to its class and place
  std::vector<Alternative> alternatives;               ///< most probable first; the rest is that it is itself
  int64_t last_observation = 0;                        ///< memory's number
  std::vector<PendingObservation> pending;             ///< while tentative
  /// Alternative hypothesis to a move: key of the object that is believed to have moved away from here. This
  /// is that object if another one was observed elsewhere. Tentative until its spot is observed again. 0 =
  /// none.
  int64_t alternative_of = 0;
  /// Probability of being clutter, of an object that appeared where nothing new was expected. 0 = not so, or
  /// resolved by a later view.
  double clutter_probability = 0;
  int64_t former_id = 0;  ///< while tentative: number that it gets if that is free; not stored

  double probability_itself() const;
};

/// How often objects in full view are detected, learned from those that were found again where they had been
/// missed.
struct DetectionRate {
  double detected = 0, missed = 0;

  double value(const BeliefOptions& options) const {
    constexpr double kPrior = kParameters.detection_prior;
    return (detected + kPrior * options.detection) / (detected + missed + kPrior);
  }
};

/// All that the belief carries from one scene to the next.
struct BeliefState {
  std::vector<ProtoObject> objects;  ///< in order of first observation
  std::optional<TimeNs> last_scene;
  double exposure_s = 0;  ///< seconds in which objects could be handled; watched time counts less
  int64_t next_key = 1;
  int64_t next_id = 1;
  InteractionModel interaction;
  Calibration calibration;  ///< of similarity
  DetectionRate detection;
  PlaceHistories places;  ///< what was seen of each place
  NoiseScale view_noise;  ///< of positions between view points, relative to the options

  const ProtoObject* find(int64_t id) const;
};

/// Key of an object in the interaction model.
InteractionKey interaction_key(const ProtoObject& object);
/// Probability that an object was handled between its last update and a time (BeliefState::exposure_s).
double interaction_probability(const ProtoObject& object, double exposure_s, const BeliefState& state,
                               const BeliefOptions& options);
/// Probability that an object still is where it was observed last, as of the last scene.
double probability_here(const ProtoObject& object, const BeliefState& state, const BeliefOptions& options);
/// Probability that an object still is on the place where it was observed last: whatever was handled since
/// its spot was last observed may have been put down elsewhere on the same place.
double probability_on_place(const ProtoObject& object, const BeliefState& state,
                            const BeliefOptions& options);
/// The surface of an object in the map frame, for the poses that places have now.
Surface surface_in_map(const ProtoObject& object, const std::vector<PlacePose>& places);
/// The key points of a view in the map frame, for the poses that places have now.
Texture texture_in_map(const TextureView& view, const std::vector<PlacePose>& places);
/// The box of an object in the map frame, for the poses that places have now.
AxisBox box_in_map(const ProtoObject& object, const std::vector<PlacePose>& places);

}  // namespace loci::memory::belief
