#include "memory/belief/association/fusion.h"

#include <algorithm>
#include <map>

#include "memory/belief/evidence/proximity.h"
#include "memory/belief/evidence/texture.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

/// From the same view point the faces are averaged. Another one shows further parts: the box grows quickly
/// and shrinks slowly, but does shrink, so that it stays around most views and not around all. What one view
/// changes is bounded by what views differ: a cluster that holds a neighbour hardly counts, a side that stays
/// in view does.
AxisBox fused_box(const AxisBox& believed, const AxisBox& seen, double gain, bool other_view) {
  const double outward = other_view ? std::max(gain, kParameters.grow_gain) : gain;
  const double inward = other_view ? kParameters.shrink_gain : gain;
  Vector3d low = believed.low(), high = believed.high();
  for (int axis = 0; axis < 3; ++axis) {
    const double most =
        kParameters.max_resize_deviations *
        (kParameters.extent_noise_m + kParameters.extent_noise_per_size * believed.size[axis]);
    const double below = std::clamp(seen.low()[axis] - low[axis], -most, most);
    const double above = std::clamp(seen.high()[axis] - high[axis], -most, most);
    low[axis] += (below < 0 ? outward : inward) * below;
    high[axis] += (above > 0 ? outward : inward) * above;
  }
  return {(low + high) / 2, high - low};
}

/// Value of storing a view.
double storage_value(const StoredView& view) {
  return view.partial ? view.weight : view.weight + kParameters.whole_view_bonus;
}

constexpr double kMaxColorDeviation = 4;  ///< log likelihood that noise costs in 95 of 100 views

/// Log ratio from which two views show the same side. Noise alone keeps two equal mean colours below what
/// other descriptors reach.
double same_view_ratio(const std::vector<Descriptor>& descriptors, const Corrections& corrections) {
  const bool only_color = descriptors.size() == 1 && descriptors.front().kind == "mean_color";
  if (!only_color) return kParameters.same_view_log_ratio;
  const Appearance color(descriptors);
  return std::min(kParameters.same_view_log_ratio,
                  compare(color, color, {}, 1, corrections).log_ratio - kMaxColorDeviation);
}

/// Replaces the mean colour by the mean over all views, of which this one has a share.
void average_color(const std::vector<Descriptor>& before, double share, std::vector<Descriptor>& now) {
  for (Descriptor& color : now) {
    if (color.kind != "mean_color") continue;
    for (const Descriptor& other : before)
      if (other.kind == color.kind && other.values.size() == color.values.size())
        for (size_t i = 0; i < color.values.size(); ++i)
          color.values[i] += (other.values[i] - color.values[i]) * static_cast<float>(1 - share);
  }
}

}  // namespace

void reset_box(ProtoObject& object, const Observation& observation, const Scene& scene,
               const BeliefOptions& options) {
  object.box = observation.box;
  object.place = observation.place;
  object.box.centre = place_pose(object.place, scene.places).inverse() * observation.box.centre;
  object.variance = observation_variance(observation, options);
  object.partial = observation.partial;
  object.has_size = observation.has_size || object.has_size;
}

void fuse_box(ProtoObject& object, const Prediction& predicted, const Observation& observation,
              const Scene& scene, const BeliefOptions& options) {
  AxisBox box_now = predicted.box;
  if (observation.has_size && !object.has_size) box_now.size = observation.box.size;
  object.has_size = object.has_size || observation.has_size;
  const double noise = observation_variance(observation, options);
  if (object.partial && !observation.partial) {
    reset_box(object, observation, scene, options);
    return;
  }
  if (observation.partial) {
    if (!object.partial) return;  // a whole view outweighs a partial one
    object.box = fused_box(box_now, observation.box, kParameters.grow_gain, true);
    object.box.centre = place_pose(object.place, scene.places).inverse() * object.box.centre;
    return;
  }
  const double variance = std::max(predicted.variance, 1e-12);
  const double gain = variance / (variance + noise);
  const bool other_view = !object.map_from_camera.isApprox(scene.view.map_from_camera, 1e-9);
  const AxisBox fused = fused_box(box_now, observation.box, gain, other_view);
  object.box.size = fused.size;
  object.box.centre = place_pose(object.place, scene.places).inverse() * fused.centre;
  object.variance = std::max(variance * noise / (variance + noise), kParameters.min_variance_share * noise);
}

void set_place(ProtoObject& object, const std::string& place, const Scene& scene) {
  if (object.place == place) return;
  const Isometry3d to_place =
      place_pose(place, scene.places).inverse() * place_pose(object.place, scene.places);
  object.box.centre = to_place * object.box.centre;
  for (Eigen::Vector3f& point : object.surface) point = to_place.cast<float>() * point;
  object.place = place;
}

void store_view(ProtoObject& object, const Observation& observation, const Scene& scene,
                const BeliefOptions& options, const Corrections& corrections, bool position_confirmed) {
  if (observation.descriptors.empty()) return;
  const Appearance seen(observation.descriptors);
  StoredView* nearest = nullptr;
  double nearest_ratio = -1e9;
  for (StoredView& view : object.views) {
    const double ratio =
        compare(Appearance(view.descriptors), seen, {view.partial, observation.partial}, 1, corrections)
            .log_ratio;
    if (ratio > nearest_ratio) {
      nearest_ratio = ratio;
      nearest = &view;
    }
  }
  StoredView fresh{observation.descriptors, 1, scene.time, observation.partial};
  if (nearest != nullptr && nearest_ratio >= same_view_ratio(observation.descriptors, corrections)) {
    nearest->weight += 1;
    if (!nearest->partial && observation.partial) return;
    average_color(nearest->descriptors, 1 / nearest->weight, fresh.descriptors);
    nearest->descriptors = std::move(fresh.descriptors);
    nearest->time = fresh.time;
    nearest->partial = fresh.partial;
  } else if (!position_confirmed && nearest != nullptr) {
    return;
  } else if (object.views.size() < size_t(options.views)) {
    object.views.push_back(std::move(fresh));
  } else {
    *std::ranges::min_element(object.views, {}, storage_value) = std::move(fresh);
  }
}

void store_surface(ProtoObject& object, const Surface& seen, const std::vector<PointState>& before,
                   const Scene& scene, bool moved) {
  Surface kept;
  for (size_t i = 0; i < before.size() && !moved; ++i)
    if (before[i] == PointState::hidden || before[i] == PointState::unknown)
      kept.push_back(object.surface[i]);
  const Eigen::Isometry3f place_from_map = place_pose(object.place, scene.places).inverse().cast<float>();
  for (const Eigen::Vector3f& point : seen) kept.push_back(place_from_map * point);
  const size_t step = (kept.size() + kParameters.surface_points - 1) / kParameters.surface_points;
  object.surface.clear();
  for (size_t i = 0; i < kept.size(); i += step) object.surface.push_back(kept[i]);
  object.surface_camera = scene.view.map_from_camera;
}

void store_texture(ProtoObject& object, const Observation& observation, const Scene& scene, bool moved,
                   bool learn) {
  if (moved)
    for (TextureView& view : object.textures) view.in_place = false;
  if (observation.texture.empty() || !learn) return;
  const Vector3d towards = towards_camera(observation, scene);
  if (std::ranges::any_of(object.textures, [&](const TextureView& view) {
        return view.time == scene.time || (view.in_place && is_same_side(view.towards_camera, towards));
      }))
    return;
  if (object.textures.size() >= kParameters.textures) {
    const auto left = std::ranges::find(object.textures, false, &TextureView::in_place);
    object.textures.erase(left != object.textures.end() ? left : object.textures.begin());
  }
  const Eigen::Isometry3f place_from_map =
      place_pose(observation.place, scene.places).inverse().cast<float>();
  TextureView view{observation.texture, observation.place, scene.time, towards, observation.range, true};
  for (SurfaceKeypoint& keypoint : view.texture) keypoint.position = place_from_map * keypoint.position;
  object.textures.push_back(std::move(view));
}

std::string most_probable_class(const ProtoObject& object) {
  std::map<std::string, double> weights;
  for (const StoredView& view : object.views)
    for (const Descriptor& descriptor : view.descriptors)
      for (size_t i = 0; descriptor.kind == "class" && i < descriptor.names.size(); ++i)
        weights[descriptor.names[i]] += view.weight * descriptor.values[i];
  const auto most = std::max_element(weights.begin(), weights.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == weights.end() ? std::string() : most->first;
}

}  // namespace loci::memory::belief
