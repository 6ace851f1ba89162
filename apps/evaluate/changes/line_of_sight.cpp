#include "apps/evaluate/changes/line_of_sight.h"

#include <cmath>

namespace loci::apps::changes {
namespace {

constexpr float kAboveFurniture = 2.3F;  // m

}  // namespace

LineOfSight::LineOfSight(const mapping::World& world, const mapping::MeshSearch& search, Warnings& warnings) {
  scene_.add(world, search, Isometry3d::Identity(), warnings);
}

bool LineOfSight::in_room(const Vector3d& from, const Vector3d& to) const {
  const Eigen::Vector3f start(static_cast<float>(from.x()), static_cast<float>(from.y()), kAboveFurniture);
  const Eigen::Vector3f end(static_cast<float>(to.x()), static_cast<float>(to.y()), kAboveFurniture);
  const float distance = (end - start).norm();
  if (distance > 0 && scene_.cast(start, (end - start) / distance, distance).link >= 0) return false;
  int walled = 0;
  constexpr int kDirections = 24;
  for (int i = 0; i < kDirections; ++i) {
    const float angle = 2.F * static_cast<float>(kPi) * static_cast<float>(i) / kDirections;
    walled += scene_.cast(end, {std::cos(angle), std::sin(angle), 0}, 10).link >= 0 ? 1 : 0;
  }
  return walled > kDirections / 2;
}

bool LineOfSight::sees(const Vector3d& camera, const Vector3d& target) const {
  constexpr double kAbove = 0.3;  // of what stands there
  return in_room(target, camera) && free_line(camera, target + Vector3d(0, 0, kAbove));
}

bool LineOfSight::free_line(const Vector3d& from, const Vector3d& to) const {
  const Vector3d line = to - from;
  return scene_.cast(from.cast<float>(), line.normalized().cast<float>(), static_cast<float>(line.norm()))
             .link < 0;
}

double LineOfSight::height_above_ground(const Vector3d& point) const {
  return static_cast<double>(scene_.cast(point.cast<float>(), {0, 0, -1}, 10).distance);
}

}  // namespace loci::apps::changes
