#pragma once

#include <limits>
#include <vector>

#include "memory/belief/evidence/proximity.h"
#include "memory/belief/evidence/visibility.h"
#include "memory/belief/state.h"

namespace loci::memory::belief {

/// Temporal context of a scene.
struct SceneTiming {
  SceneTiming(const BeliefState& state, const Scene& scene, const BeliefOptions& options);

  double seconds = std::numeric_limits<double>::infinity();  ///< since the last scene
  bool snapshot = true;     ///< too far from other scenes in time to be confirmed by them
  bool independent = true;  ///< of the last scene: its events are training data
  double exposure_s = 0;    ///< BeliefState::exposure_s at the time of the scene
};

/// A believed object as it is predicted for a scene.
struct Prediction {
  AxisBox box;               ///< map frame
  bool with_depth = true;    ///< of the sensor
  double variance = 0;       ///< of the centre, without the observation's own noise, m²
  double view_variance = 0;  ///< that another view point adds, as the options state it
  double interaction = 0;    ///< probability of having been handled since the last view
  double appearance_change =
      0;               ///< probability of another appearance at the same spot: another side, or handled
  double here = 1;     ///< probability of still being there
  BoxVisibility seen;  ///< what observing its spot showed
  std::vector<PointState>
      surface;             ///< what became of the points of its surface, if it was not seen shortly before
  double log_surface = 0;  ///< surface_log_ratio() of it
  /// Probability of having been put down, unseen since, on each place of the scene (`PlaceView`).
  std::vector<double> moved_to;
  double carried_off = 0;   ///< probability
  double undetectable = 0;  ///< probability of not being detected if there: too little in view
  double resolved = 1;      ///< how much less often so few pixels show it than those of its last observation
};

/// The places that the scene shows; those of its observations come first, and their extent grows.
std::vector<PlaceView> view_places(BeliefState& state, const Scene& scene, const BeliefOptions& options);
/// Index of a place in the list.
size_t index_of(const std::vector<PlaceView>& places, const std::string& name);

std::vector<Prediction> predict(const BeliefState& state, const Scene& scene,
                                const std::vector<PlaceView>& places, const BeliefOptions& options);

/// Expected number of new objects, clutter included, on a place that the scene shows. A video shows hidden
/// parts anew.
double expected_arrivals(const PlaceView& place, const SceneTiming& timing, const BeliefState& state,
                         const BeliefOptions& options);

/// Errors between a prediction and an observation. What a sensor with depth errs while it stands still is
/// known; the error between two view points, and all of a detector without depth, is learned.
PositionNoise position_noise(const ProtoObject& object, const Prediction& predicted,
                             const Observation& observation, const NoiseScale::Levels& weights,
                             const BeliefOptions& options);

/// The same for points of a surface that are recognised one by one.
PositionNoise surface_noise(const ProtoObject& object, const Isometry3d& map_from_camera, double range,
                            const NoiseScale::Levels& weights, const BeliefOptions& options);

/// Log likelihoods of what was measured at a spot, of an object that is there and of one that is gone.
struct AbsenceEvidence {
  double if_there = 0;
  double if_gone = 0;
};
/// Views in quick succession count for less. Flat objects are hardly distinguishable from the surface, and
/// often missed. `detection` is the rate of others. A detector without depth only tells that it found
/// nothing.
AbsenceEvidence absence_evidence(const Prediction& predicted, double empty_share, double seconds,
                                 double detection, const BeliefOptions& options);

/// Share of an object's observed spot that speaks against the object: seen through, or occupied by another.
/// `other[k]`: probability that observation k is another object.
double empty_share(const BoxVisibility& seen, const std::vector<double>& other);

/// Whether an observation is a piece of the object predicted in a box: it lies inside and is much smaller. In
/// a video, objects appear so that are cut by occlusion, glare or missing depth.
bool is_piece(const Prediction& predicted, const AxisBox& seen);

/// Share of an observation within a predicted box and its uncertainty.
double covered_share(const Prediction& predicted, const AxisBox& seen);

}  // namespace loci::memory::belief
