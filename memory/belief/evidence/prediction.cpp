#include "memory/belief/evidence/prediction.h"

#include <algorithm>
#include <cmath>

#include "memory/belief/parameters.h"

namespace loci::memory::belief {

SceneTiming::SceneTiming(const BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  if (state.last_scene) seconds = in_seconds(scene.time - *state.last_scene);
  const double after = scene.seconds_to_next.value_or(std::numeric_limits<double>::infinity());
  snapshot = std::min(seconds, after) >= options.snapshot_gap_s;
  independent = seconds >= options.snapshot_gap_s;
  exposure_s = state.exposure_s;
  if (state.last_scene) exposure_s = state.exposure_s + (snapshot ? 1.0 : options.watched) * seconds;
}

namespace {

/// Share of a place that a scene shows, by the lines of sight to where objects were found on it.
double shown_share(const PlaceView& view, const PlaceHistory& place, const Scene& scene,
                   const BeliefOptions& options) {
  if (!is_place_known(view.name, scene.places)) return 0;
  AxisBox box = place.extent;
  constexpr double kMin = kParameters.min_place_extent_m;
  box.size = box.size.cwiseMax(Vector3d(kMin, kMin, 0.1));
  box.centre = place_pose(view.name, scene.places) * box.centre;
  const double share = (scene.view.depth.empty() ? box_visibility_without_depth(scene.view, box, 0, view.name,
                                                                                {}, options.visibility)
                                                 : box_visibility(scene.view, box, 0, 0, options.visibility))
                           .visibility.observed();
  const bool found_there = std::ranges::any_of(
      scene.observations, [&](const Observation& observation) { return observation.place == view.name; });
  return found_there ? std::max(kParameters.min_observed, share) : share;
}

/// Share of a gone object's chance of having been carried off in which it is back.
double returned(const ProtoObject& object, const BeliefState& state, double exposure_s,
                const BeliefOptions& options) {
  if (object.status != Status::gone) return 0;
  return state.interaction.returns(exposure_s - object.last_seen_exposure_s, options);
}

/// Where an object is if it was handled: a share of its probability mass per place of the scene, and carried
/// off. What was put down and would have been seen since is excluded; `returns` of what was carried off is
/// back since the last scene.
void predict_locations(const ProtoObject& object, const BeliefState& state,
                       const std::vector<std::optional<size_t>>& view_of, size_t views,
                       const std::vector<double>& destinations, double exposure_s, double returns,
                       Prediction& p) {
  const double since = object.last_seen_exposure_s;
  const double until = object.status == Status::gone ? object.gone_by_s : exposure_s;
  p.moved_to.assign(views, 0.0);
  std::vector<double> shares(views, 0.0);
  double put_down = 0, unseen = 0;
  size_t i = 0;
  for (const auto& [name, place] : state.places) {
    const double share = destinations[i];
    const std::optional<size_t> view = view_of[i++];
    const double still_unseen = share * place.unseen_share(since, until);
    put_down += share;
    unseen += still_unseen;
    if (!view) continue;
    p.moved_to[*view] = still_unseen;
    shares[*view] = share;
  }
  const double off = std::max(0.0, 1 - put_down);
  const double handled = (1 - p.here) / std::max(1e-9, unseen + off);
  p.carried_off = handled * off;
  for (size_t view = 0; view < views; ++view)
    p.moved_to[view] =
        handled * p.moved_to[view] + p.carried_off * returns * shares[view] / std::max(1e-9, put_down);
}

}  // namespace

std::vector<PlaceView> view_places(BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  std::vector<PlaceView> views;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(views, name, &PlaceView::name) == views.end()) views.push_back({name});
  };
  for (const Observation& observation : scene.observations) {
    const Isometry3d& pose = place_pose(observation.place, scene.places);
    const AxisBox spot{pose.inverse() * observation.box.centre, Vector3d::Zero()};
    const auto [place, is_new] = state.places.try_emplace(observation.place);
    place->second.extent = is_new ? spot : join(place->second.extent, spot);
    if (is_new) place->second.map_from_place = pose;
    add(observation.place);
  }
  if (scene.view.observed)
    for (const ObservedPlace& observed : *scene.view.observed) add(observed.name);
  else
    for (const auto& [name, place] : state.places) add(name);
  const double now = SceneTiming(state, scene, options).exposure_s;
  for (PlaceView& view : views) {
    const auto place = state.places.find(view.name);
    if (place == state.places.end()) continue;
    view.share = shown_share(view, place->second, scene, options);
    if (place->second.views.empty()) continue;
    view.never_seen = place->second.never_seen;
    view.unseen_seconds = place->second.unseen_seconds(place->second.begin_s, now);
  }
  std::erase_if(views, [](const PlaceView& view) { return view.share < kParameters.min_place_share; });
  return views;
}

size_t index_of(const std::vector<PlaceView>& places, const std::string& name) {
  return static_cast<size_t>(std::ranges::find(places, name, &PlaceView::name) - places.begin());
}

std::vector<Prediction> predict(const BeliefState& state, const Scene& scene,
                                const std::vector<PlaceView>& places, const BeliefOptions& options) {
  std::vector<Prediction> predictions;
  const SceneTiming timing(state, scene, options);
  const double exposure = timing.exposure_s;
  const double view_noise = state.view_noise.variance_factor(options.noise_spread);
  std::map<std::string, std::vector<double>> destinations_from;
  std::vector<std::optional<size_t>> view_of;  // of the places of the state
  for (const auto& [name, place] : state.places) {
    const size_t view = index_of(places, name);
    view_of.push_back(view < places.size() ? std::optional(view) : std::nullopt);
  }
  for (const ProtoObject& object : state.objects) {
    Prediction p;
    p.box = box_in_map(object, scene.places);
    p.with_depth = !scene.view.depth.empty();
    p.view_variance = view_change_variance(object.map_from_camera, scene.view.map_from_camera,
                                           p.box.size.maxCoeff(), options);
    p.variance = (p.with_depth ? 1 : view_noise) * object.variance + view_noise * p.view_variance;
    p.interaction = interaction_probability(object, exposure, state, options);
    const double motion = camera_motion(object.map_from_camera, scene.view.map_from_camera);
    p.here = object.probability_here * (1 - p.interaction);
    p.appearance_change = kParameters.base_appearance_change +
                          (p.with_depth ? p.interaction : 1 - p.here) / 2 +
                          options.newview * (1 - std::exp(-motion / kParameters.turn_motion));
    if (!p.with_depth)  // which surfaces another side shows is nothing that a home teaches
      p.appearance_change = std::min(kParameters.max_appearance_change,
                                     p.appearance_change * state.interaction.change_factor());
    auto destinations = destinations_from.find(object.place);
    if (destinations == destinations_from.end())
      destinations =
          destinations_from.emplace(object.place, state.interaction.destinations(object.place, state.places))
              .first;
    predict_locations(object, state, view_of, places.size(), destinations->second, exposure,
                      returned(object, state, exposure, options), p);
    p.seen = scene.view.depth.empty()
                 ? box_visibility_without_depth(scene.view, p.box, std::sqrt(p.variance), object.place,
                                                scene.observations, options.visibility)
                 : box_visibility(scene.view, p.box, std::sqrt(p.variance), scene.observations.size(),
                                  options.visibility);
    if (!is_place_known(object.place, scene.places)) {
      p.seen.visibility = {.out_of_view = 1};
      std::ranges::fill(p.seen.occupied_by, 0.0);
    }
    const double unobserved_s = in_seconds(scene.time - object.last_seen);
    if (unobserved_s >= options.snapshot_gap_s && !object.surface.empty()) {
      const double pose_variance =
          view_noise * view_change_variance(object.surface_camera, scene.view.map_from_camera, 0, options);
      p.surface = observe_surface(scene.view, surface_in_map(object, scene.places), p.box.low().z(),
                                  std::sqrt(pose_variance), options.visibility);
      if (const std::optional<double> displaced = displaced_share(p.surface))
        p.log_surface = surface_log_ratio(*displaced);
    }
    // Without a size the sampled box is the uncertainty of the position. Nothing is certainly out of view.
    constexpr double kMinInView = 1e-3;
    p.undetectable = object.has_size ? undetectable(p.seen.visibility, timing.seconds)
                                     : std::clamp(1 - p.seen.visibility.observed(), 0.0, 1 - kMinInView);
    if (p.with_depth && object.has_size)
      p.resolved = std::min(1.0, resolved(scene.view, scene.view.map_from_camera, p.box) /
                                     resolved(scene.view, object.map_from_camera, p.box));
    predictions.push_back(std::move(p));
  }
  return predictions;
}

double expected_arrivals(const PlaceView& place, const SceneTiming& timing, const BeliefState& state,
                         const BeliefOptions& options) {
  const InteractionModel& model = state.interaction;
  if (!model.knows(place.name)) return options.appear * model.statistics().first_view.value();
  if (!timing.snapshot) return options.appear * model.statistics().later_view.value();
  return model.arrivals(place, options);
}

PositionNoise position_noise(const ProtoObject& object, const Prediction& predicted,
                             const Observation& observation, const NoiseScale::Levels& weights,
                             const BeliefOptions& options) {
  const double still = object.variance + observation_variance(observation, options);
  if (!predicted.with_depth) return {0, still + predicted.view_variance, weights};
  return {still, predicted.view_variance, weights};
}

PositionNoise surface_noise(const ProtoObject& object, const Isometry3d& map_from_camera, double range,
                            const NoiseScale::Levels& weights, const BeliefOptions& options) {
  Observation point;
  point.range = range;
  return {2 * observation_variance(point, options),
          view_change_variance(object.map_from_camera, map_from_camera, 0, options), weights};
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
  const double detection = predicted.resolved * detection_rate *
                           (kParameters.flat_detection + (1 - kParameters.flat_detection) * solid);
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
