#include "nbv/sight.h"

#include <cmath>

#include "mapping/base/math.h"

namespace loci::nbv {
namespace {

constexpr double kClearance = 0.1;  ///< m before a surface where a ray may end: its own voxels hide nothing

}  // namespace

bool Sight::sees(const Vector3d& from, const Vector3d& point, const Vector3d& normal) const {
  const Vector3d ray = point - from;
  const double distance = ray.norm();
  if (ray.dot(normal) >= 0 || distance < 2 * laser_.range_min_m || distance > laser_.range_max_m)
    return false;
  const double tilt = std::asin(ray.z() / distance) / kDegree;
  return tilt >= laser_.tilt_min_deg && tilt <= laser_.tilt_max_deg &&
         !hidden(from, point + kClearance * normal);
}

bool Sight::hidden(const Vector3d& from, const Vector3d& to) const {
  const double length = (to - from).norm(), step = 0.5 * voxels_.resolution;
  for (double at = step; at < length; at += step)
    if (voxels_.at(voxels_.voxel_of(from + at / length * (to - from))) == mapping::Occupancy::occupied)
      return true;
  return false;
}

bool in_sector(const Vector3d& from, const Vector3d& to, double yaw, const mapping::LaserModel& laser) {
  const double azimuth = std::remainder(std::atan2(to.y() - from.y(), to.x() - from.x()) - yaw, 2 * kPi);
  return std::abs(azimuth) <= 0.5 * laser.azimuth_range_deg * kDegree;
}

}  // namespace loci::nbv
