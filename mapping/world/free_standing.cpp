#include "mapping/world/free_standing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace loci::mapping {
namespace {

/// Whether it is fixed to a wall above the floor. Legs of chrome are not seen: seats seem to float.
bool hangs(const std::vector<Eigen::Vector3f>& points, double bottom,
           const std::vector<WallRectangle>& walls) {
  if (bottom <= kFreeStanding.stands_m) return false;
  return std::ranges::any_of(points, [&](const Eigen::Vector3f& point) {
    return std::ranges::any_of(
        walls, [&](const WallRectangle& wall) { return wall.near(point, kFreeStanding.hanging_wall_m); });
  });
}

/// Whether it stands along a wall as cabinets do.
bool is_built_in(const std::vector<Eigen::Vector3f>& points, double top,
                 const std::vector<WallRectangle>& walls) {
  for (const WallRectangle& wall : walls) {
    double low = 1e9, high = -1e9;
    for (const Eigen::Vector3f& point : points) {
      if (!wall.near(point, kFreeStanding.beside_wall_m)) continue;
      const double along = point.head<2>().cast<double>().dot(Vector2d(-wall.normal.y(), wall.normal.x()));
      low = std::min(low, along);
      high = std::max(high, along);
    }
    if (high - low > kFreeStanding.fixed_width_m) return true;
    if (high > low && top > kFreeStanding.fixed_height_m) return true;
  }
  return false;
}

}  // namespace

bool WallRectangle::near(const Eigen::Vector3f& point, double margin) const {
  const Vector2d p = point.head<2>().cast<double>();
  if (std::abs(normal.dot(p) - offset) > margin) return false;
  const double along = p.dot(Vector2d(-normal.y(), normal.x()));
  const double z = static_cast<double>(point.z());
  return along > along_min - margin && along < along_max + margin && z > bottom - margin && z < top + margin;
}

bool stands_free(const std::vector<Eigen::Vector3f>& points, const std::vector<WallRectangle>& walls,
                 bool may_hang) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  if (box.isEmpty()) return false;
  const double extent = static_cast<double>(box.sizes().head<2>().maxCoeff());
  const double top = static_cast<double>(box.max().z()), bottom = static_cast<double>(box.min().z());
  if (extent > kFreeStanding.max_extent_m || extent < kFreeStanding.min_extent_m) return false;
  if (top < kFreeStanding.min_top_m) return false;
  if (may_hang && hangs(points, bottom, walls)) return false;
  return !is_built_in(points, top, walls);
}

bool is_furniture_motion(const Isometry3d& now_from_before, const Vector3d& point) {
  return (now_from_before * point - point).norm() >= kFurnitureMotion.min_move_m ||
         Eigen::AngleAxisd(now_from_before.linear()).angle() >= kFurnitureMotion.min_move_deg * kDegree;
}

}  // namespace loci::mapping
