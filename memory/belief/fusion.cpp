#include "memory/belief/fusion.h"

#include <algorithm>
#include <map>

#include "memory/belief/belief.h"
#include "memory/belief/proximity.h"

namespace loci::memory::belief {
namespace {

const Isometry3d& pose_of(const std::string& place, const std::vector<PlacePose>& places) {
  static const Isometry3d still = Isometry3d::Identity();
  for (const PlacePose& pose : places)
    if (pose.name == place) return pose.map_from_place;
  return still;
}

/// A camera that stands still sees the same side again: the faces are averaged. Another view point sees
/// further parts: the box grows quickly and shrinks slowly.
AxisBox fused_box(const AxisBox& believed, const AxisBox& seen, double gain, bool other_view) {
  // Much more than before is rather two things in one cluster.
  const bool swallowed = other_view && seen.volume() > 2.5 * believed.volume();
  const double outward = swallowed ? 0.1 * gain : other_view ? std::max(gain, 0.5) : gain;
  const double inward = other_view ? 0.1 * gain : gain;
  Vector3d low = believed.low(), high = believed.high();
  for (int axis = 0; axis < 3; ++axis) {
    const double below = seen.low()[axis] - low[axis], above = seen.high()[axis] - high[axis];
    low[axis] += (below < 0 ? outward : inward) * below;
    high[axis] += (above > 0 ? outward : inward) * above;
  }
  return {(low + high) / 2, high - low};
}

/// What a look is worth keeping: whole ones before those of parts.
double worth(const Look& look) {
  return look.partial ? look.weight : look.weight + 5;
}

}  // namespace

void put(ProtoObject& object, const Observation& observation, const Scene& scene,
         const BeliefOptions& options) {
  object.box = observation.box;
  object.place = observation.place;
  object.box.centre = pose_of(object.place, scene.places).inverse() * observation.box.centre;
  object.variance = observation_variance(observation, options);
  object.partial = observation.partial;
  object.sized = observation.sized || object.sized;
}

void fuse(ProtoObject& object, const Expectation& expected, const Observation& observation,
          const Scene& scene, const BeliefOptions& options) {
  AxisBox box_now = expected.box;
  if (observation.sized && !object.sized) box_now.size = observation.box.size;
  object.sized = object.sized || observation.sized;
  const double noise = observation_variance(observation, options);
  if (object.partial && !observation.partial) {
    put(object, observation, scene, options);
    return;
  }
  if (observation.partial) {
    if (!object.partial) return;  // a whole view is worth more than a part
    AxisBox both = join(box_now, observation.box);
    both.centre = pose_of(object.place, scene.places).inverse() * both.centre;
    object.box = both;
    return;
  }
  const double variance = std::max(expected.variance, 1e-12);
  const double gain = variance / (variance + noise);
  const bool other_view = !object.map_from_camera.isApprox(scene.view.map_from_camera, 1e-9);
  const AxisBox fused = fused_box(box_now, observation.box, gain, other_view);
  object.box.size = fused.size;
  object.box.centre = pose_of(object.place, scene.places).inverse() * fused.centre;
  // Errors of one view point repeat: the position never becomes much better than one look.
  object.variance = std::max(variance * noise / (variance + noise), noise / 4);
}

void set_place(ProtoObject& object, const std::string& place, const Scene& scene) {
  if (object.place == place) return;
  object.box.centre =
      pose_of(place, scene.places).inverse() * (pose_of(object.place, scene.places) * object.box.centre);
  object.place = place;
}

void remember_look(ProtoObject& object, const Observation& observation, const Scene& scene,
                   const BeliefOptions& options, bool vouched_for) {
  if (observation.descriptors.empty()) return;
  Look* nearest = nullptr;
  double nearest_ratio = -1e9;
  for (Look& look : object.looks) {
    const double ratio =
        compare(look.descriptors, observation.descriptors, look.partial || observation.partial, 1).log_ratio;
    if (ratio > nearest_ratio) {
      nearest_ratio = ratio;
      nearest = &look;
    }
  }
  const Look fresh{observation.descriptors, 1, scene.time, observation.partial};
  const double alike = 2.5;  // sum of log ratios from which two looks say the same
  if (nearest != nullptr && nearest_ratio >= alike) {
    nearest->weight += 1;
    if (!nearest->partial && observation.partial) return;
    nearest->descriptors = fresh.descriptors;
    nearest->time = fresh.time;
    nearest->partial = fresh.partial;
  } else if (!vouched_for && nearest != nullptr) {
    return;
  } else if (object.looks.size() < size_t(options.views)) {
    object.looks.push_back(fresh);
  } else {
    *std::min_element(object.looks.begin(), object.looks.end(),
                      [](const Look& a, const Look& b) { return worth(a) < worth(b); }) = fresh;
  }
}

std::string kind_of(const ProtoObject& object) {
  std::map<std::string, double> names;
  for (const Look& look : object.looks)
    for (const Descriptor& descriptor : look.descriptors)
      for (size_t i = 0; descriptor.kind == "class" && i < descriptor.names.size(); ++i)
        names[descriptor.names[i]] += look.weight * descriptor.values[i];
  const auto most = std::max_element(names.begin(), names.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == names.end() ? std::string() : most->first;
}

AxisBox box_in_map(const ProtoObject& object, const std::vector<PlacePose>& places) {
  return {pose_of(object.place, places) * object.box.centre, object.box.size};
}

}  // namespace loci::memory::belief
