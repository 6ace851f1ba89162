#include "memory/belief/scene.h"

#include <algorithm>

namespace loci::memory::belief {

double shared_volume(const AxisBox& a, const AxisBox& b) {
  const Vector3d overlap = a.high().cwiseMin(b.high()) - a.low().cwiseMax(b.low());
  return (overlap.array() > 0).all() ? overlap.prod() : 0.0;
}

AxisBox join(const AxisBox& a, const AxisBox& b) {
  const Vector3d low = a.low().cwiseMin(b.low());
  const Vector3d high = a.high().cwiseMax(b.high());
  return {(low + high) / 2, high - low};
}

const Isometry3d& place_pose(const std::string& place, const std::vector<PlacePose>& places) {
  static const Isometry3d identity = Isometry3d::Identity();
  for (const PlacePose& pose : places)
    if (pose.name == place) return pose.map_from_place;
  return identity;
}

bool is_place_known(const std::string& place, const std::vector<PlacePose>& places) {
  return std::ranges::none_of(places,
                              [&](const PlacePose& pose) { return pose.name == place && !pose.known; });
}

}  // namespace loci::memory::belief
