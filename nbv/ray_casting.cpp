#include "nbv/ray_casting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/base/math/math.h"

namespace loci::nbv {
namespace {

constexpr double kDepth = 1;        ///< metres of the unknown in which a ray surely meets something
constexpr double kClearance = 0.1;  ///< m before a surface where a ray may end: its own voxels hide nothing

}  // namespace

ViewCaster::ViewCaster(const mapping::Voxels& voxels, const ViewVoxels& view,
                       const mapping::LaserModel& laser, double range_max, double step_deg)
    : voxels_(voxels),
      view_(view),
      height_(laser.height_m),
      opening_(laser.azimuth_range_deg * kDegree),
      range_max_(std::min(range_max, laser.range_max_m)),
      columns_(std::max(8, static_cast<int>(std::lround(360 / step_deg)))) {
  step_ = 2 * kPi / columns_;
  const int rows =
      std::max(1, static_cast<int>(std::lround((laser.tilt_max_deg - laser.tilt_min_deg) / step_deg)));
  for (int i = 0; i < rows; ++i) {
    const double tilt =
        (laser.tilt_min_deg + (laser.tilt_max_deg - laser.tilt_min_deg) * (i + 0.5) / rows) * kDegree;
    tilts_.push_back({std::sin(tilt), std::cos(tilt)});
  }
}

/// Goes from voxel to voxel (Amanatides and Woo 1987) to the first surface, or through a window into the
/// unknown as far as that reaches.
void ViewCaster::cast(const Vector3d& origin, const Vector3d& direction, double area,
                      ViewCounts& counts) const {
  const Vector3d start = (origin - voxels_.low) / voxels_.resolution;
  Eigen::Vector3i voxel = start.array().floor().cast<int>();
  if (!voxels_.contains(voxel)) return;
  const double limit = range_max_ / voxels_.resolution;
  std::ptrdiff_t strides[3] = {1, voxels_.size.x(),
                               static_cast<std::ptrdiff_t>(voxels_.size.x()) * voxels_.size.y()};
  double next[3], delta[3];
  int left[3];  // Voxels to the border of the grid.
  for (int i = 0; i < 3; ++i) {
    const bool up = direction[i] > 0;
    delta[i] = direction[i] == 0 ? std::numeric_limits<double>::infinity() : 1 / std::abs(direction[i]);
    next[i] = direction[i] == 0 ? delta[i] : (up ? voxel[i] + 1 - start[i] : start[i] - voxel[i]) * delta[i];
    left[i] = up ? voxels_.size[i] - 1 - voxel[i] : voxel[i];
    if (!up) strides[i] = -strides[i];
  }
  const ViewVoxel* state = &view_.states[voxels_.index(voxel)];
  const double depth_max = kDepth / voxels_.resolution;
  bool was_frontier = false, began = false;
  double distance = 0, entered = -1;  // Voxel edges; where the ray went from the frontier into the unknown.
  while (true) {
    if (entered >= 0 && (*state != ViewVoxel::unknown || distance - entered >= depth_max)) break;
    if (*state == ViewVoxel::occupied) {
      counts.occupied += area * distance * distance;
      return;
    }
    if (*state == ViewVoxel::unknown && began && entered < 0) {
      if (!was_frontier) return;
      entered = distance;
    }
    began = began || *state != ViewVoxel::unknown;  // Where the sensor stands may be unknown.
    was_frontier = *state == ViewVoxel::frontier;
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    distance = next[axis];
    if (distance > limit) break;
    if (left[axis]-- == 0) {  // All is unknown outside.
      if (entered < 0 && was_frontier) entered = distance;
      if (entered >= 0) distance = entered + depth_max;
      break;
    }
    next[axis] += delta[axis];
    state += strides[axis];
  }
  if (entered < 0) return;
  const double depth = std::min({distance, limit, entered + depth_max}) - entered;
  counts.frontier += area * (entered + depth) * (entered + depth) * depth / depth_max;
}

ViewCounts ViewCaster::column(const Vector3d& origin, double azimuth) const {
  ViewCounts counts;
  const double ca = std::cos(azimuth), sa = std::sin(azimuth);
  const double tilt_step = (std::asin(tilts_.back().sine) - std::asin(tilts_.front().sine)) /
                           std::max<double>(1, static_cast<double>(tilts_.size()) - 1);
  const double voxel_area = voxels_.resolution * voxels_.resolution;
  for (const Tilt& tilt : tilts_)
    cast(origin, {tilt.cosine * ca, tilt.cosine * sa, tilt.sine},
         step_ * tilt_step * tilt.cosine * voxel_area, counts);
  return counts;
}

std::vector<ViewCounts> ViewCaster::panorama(const Vector2d& point) const {
  std::vector<ViewCounts> columns;
  for (int i = 0; i < columns_; ++i) columns.push_back(column({point.x(), point.y(), height_}, i * step_));
  return columns;
}

ViewCounts ViewCaster::part(const std::vector<ViewCounts>& panorama, double yaw) const {
  ViewCounts sum;
  const int half = static_cast<int>(std::floor(opening_ / 2 / step_ + 1e-9));
  const int middle = static_cast<int>(std::lround(yaw / step_));
  for (int i = middle - half; i <= std::min(middle + half, middle - half + columns_ - 1); ++i) {
    const ViewCounts& counts = panorama[static_cast<size_t>((i % columns_ + columns_) % columns_)];
    sum.occupied += counts.occupied;
    sum.frontier += counts.frontier;
  }
  return sum;
}

ViewCounts ViewCaster::view(const mapping::PlanarPose& pose) const {
  ViewCounts sum;
  const int half = static_cast<int>(std::floor(opening_ / 2 / step_ + 1e-9));
  const int middle = static_cast<int>(std::lround(pose.yaw / step_));
  for (int i = middle - half; i <= std::min(middle + half, middle - half + columns_ - 1); ++i) {
    const ViewCounts counts = column({pose.x, pose.y, height_}, i * step_);
    sum.occupied += counts.occupied;
    sum.frontier += counts.frontier;
  }
  return sum;
}

bool LineOfSight::sees(const Vector3d& from, const Vector3d& point, const Vector3d& normal) const {
  const Vector3d ray = point - from;
  const double distance = ray.norm();
  if (ray.dot(normal) >= 0 || distance < 2 * laser_.range_min_m || distance > laser_.range_max_m)
    return false;
  const double tilt = std::asin(ray.z() / distance) / kDegree;
  return tilt >= laser_.tilt_min_deg && tilt <= laser_.tilt_max_deg &&
         !hidden(from, point + kClearance * normal);
}

bool LineOfSight::hidden(const Vector3d& from, const Vector3d& to) const {
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
