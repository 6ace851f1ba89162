#include "memory/belief/evidence/prediction.h"

#include <algorithm>
#include <cmath>

#include "memory/belief/parameters.h"

namespace loci::memory::belief {

SceneTiming::SceneTiming(const BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  if (state.last_scene) seconds = double(scene.time - *state.last_scene) / double(kSecond);
  const double after = scene.seconds_to_next.value_or(std::numeric_limits<double>::infinity());
  snapshot = std::min(seconds, after) >= options.snapshot_gap_s;
  independent = seconds >= options.snapshot_gap_s;
  exposure_s = state.exposure_s;
  if (state.last_scene) exposure_s = state.exposure_s + (snapshot ? 1.0 : options.watched) * seconds;
}

std::vector<Prediction> predict(const BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  std::vector<Prediction> predictions;
  const double exposure = SceneTiming(state, scene, options).exposure_s;
  const double view_noise = state.view_noise.variance_factor(options.noise_spread);
  for (const ProtoObject& object : state.objects) {
    Prediction p;
    p.box = box_in_map(object, scene.places);
    p.with_depth = !scene.view.depth.empty();
    p.view_variance = view_change_variance(object.map_from_camera, scene.view.map_from_camera,
                                           p.box.size.maxCoeff(), options);
    p.variance = (p.with_depth ? 1 : view_noise) * object.variance + view_noise * p.view_variance;
    p.interaction = interaction_probability(object, exposure, state, options);
    const double motion = camera_motion(object.map_from_camera, scene.view.map_from_camera);
    p.appearance_change = kParameters.base_appearance_change + p.interaction / 2 +
                          options.newview * (1 - std::exp(-motion / kParameters.turn_motion));
    p.here = object.probability_here * (1 - p.interaction);
    p.seen = scene.view.depth.empty()
                 ? box_visibility_without_depth(scene.view, p.box, std::sqrt(p.variance), object.place,
                                                scene.observations, options.visibility)
                 : box_visibility(scene.view, p.box, std::sqrt(p.variance), scene.observations.size(),
                                  options.visibility);
    p.undetectable = undetectable(p.seen.visibility);
    predictions.push_back(std::move(p));
  }
  return predictions;
}

PositionNoise position_noise(const ProtoObject& object, const Prediction& predicted,
                             const Observation& observation, const NoiseScale::Levels& weights,
                             const BeliefOptions& options) {
  const double still = object.variance + observation_variance(observation, options);
  if (!predicted.with_depth) return {0, still + predicted.view_variance, weights};
  return {still, predicted.view_variance, weights};
}

AbsenceEvidence absence_evidence(const Prediction& predicted, double empty_share, double seconds,
                                 double detection_rate, const BeliefOptions& options) {
  const Visibility& seen = predicted.seen.visibility;
  const double searched = seen.searched > 0 ? seen.searched / seen.observed() : 0.0;
  const double taken = std::max(0.0, 1 - empty_share - searched);
  const double height = predicted.box.size.z();
  const double independence = std::clamp(seconds, kParameters.min_independence, 1.0);
  // Only in depth do flat objects merge with the surface.
  const double solid =
      searched > 0
          ? 1.0
          : std::clamp((height - kParameters.flat_height_m) / kParameters.flat_height_range_m, 0.0, 1.0);
  const double detection =
      detection_rate * (kParameters.flat_detection + (1 - kParameters.flat_detection) * solid);
  return {independence * (solid * empty_share * std::log(options.empty_if_there) + std::log(1 - detection)),
          independence * solid * taken * std::log(kParameters.occupied_if_gone)};
}

double empty_share(const BoxVisibility& seen, const std::vector<double>& other) {
  double against = seen.visibility.seen_through;
  for (size_t k = 0; k < seen.occupied_by.size(); ++k) against += seen.occupied_by[k] * other[k];
  const double observed = seen.visibility.observed();
  return observed > 0 ? std::min(1.0, against / observed) : 0.0;
}

double covered_share(const Prediction& predicted, const AxisBox& seen) {
  AxisBox grown = predicted.box;
  grown.size += Vector3d::Constant(4 * std::sqrt(predicted.variance));
  return shared_volume(grown, seen) / std::max(1e-9, seen.volume());
}

bool is_piece(const Prediction& predicted, const AxisBox& seen) {
  return seen.volume() < kParameters.piece_volume * predicted.box.volume() &&
         covered_share(predicted, seen) > kParameters.piece_covered;
}

}  // namespace loci::memory::belief
