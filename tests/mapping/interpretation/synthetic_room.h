#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping::test {

/// A box of an analytic room, turned about its vertical middle, or an upright cylinder in it.
struct Solid {
  Vector3d low, high;
  double yaw = 0;
  bool round = false;

  /// Distance along a ray to where it enters; infinite = it misses.
  double cast(const Vector3d& map_origin, const Vector3d& map_ray) const {
    const Vector3d middle = (low + high) / 2;
    const Eigen::AngleAxisd turn(-yaw, Vector3d::UnitZ());
    const Vector3d origin = middle + turn * (map_origin - middle);
    const Vector3d ray = turn * map_ray;
    double enter = 0;
    double leave = 1e9;
    for (int i = round ? 2 : 0; i < 3; ++i) {
      const double a = (low[i] - origin[i]) / ray[i];
      const double b = (high[i] - origin[i]) / ray[i];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (round) {
      const double radius = (high.x() - low.x()) / 2;
      const Vector2d from = (origin - middle).head<2>();
      const double a = ray.head<2>().squaredNorm();
      const double b = from.dot(ray.head<2>());
      const double root = b * b - a * (from.squaredNorm() - radius * radius);
      if (root < 0) return 1e9;
      enter = std::max(enter, (-b - std::sqrt(root)) / a);
      leave = std::min(leave, (-b + std::sqrt(root)) / a);
    }
    return enter < leave && enter > 0 ? enter : 1e9;
  }
};

/// A room of 4 × 3 m, 2.5 m high, seen from inside, with solids in it.
struct AnalyticRoom {
  std::vector<Solid> solids;
  Vector3d size{4, 3, 2.5};

  /// Distance along a unit ray from inside the room to what it hits.
  double cast(const Vector3d& origin, const Vector3d& ray) const {
    double nearest = 1e9;
    for (int i = 0; i < 3; ++i) {
      const double wall = ray[i] > 0 ? size[i] : 0;
      if (std::abs(ray[i]) > 1e-12) nearest = std::min(nearest, (wall - origin[i]) / ray[i]);
    }
    for (const Solid& solid : solids) nearest = std::min(nearest, solid.cast(origin, ray));
    return nearest;
  }
};

/// A table top with four legs.
inline void add_table(AnalyticRoom& room, const Vector2d& low, const Vector2d& high, double height) {
  room.solids.push_back({{low.x(), low.y(), height - 0.03}, {high.x(), high.y(), height}});
  for (const double x : {low.x() + 0.03, high.x() - 0.08})
    for (const double y : {low.y() + 0.03, high.y() - 0.08})
      room.solids.push_back({{x, y, 0}, {x + 0.05, y + 0.05, height - 0.03}});
}

/// A table in the middle of the south half, a counter along the north wall, some clutter on both.
inline AnalyticRoom kitchen() {
  AnalyticRoom room;
  add_table(room, {1.4, 0.5}, {2.6, 1.3}, 0.74);
  room.solids.push_back({{0.5, 2.4, 0}, {2.9, 3.0, 0.9}});       // counter
  room.solids.push_back({{1.8, 0.8, 0.74}, {1.95, 1.0, 0.95}});  // things on the table
  room.solids.push_back({{2.2, 0.6, 0.74}, {2.3, 0.7, 0.84}});
  room.solids.push_back({{1.2, 2.6, 0.9}, {1.5, 2.9, 1.2}});  // and on the counter
  return room;
}

/// Scans by a camera-like sensor that turns all round and looks down a little, with Gaussian noise along the
/// ray that grows with the square of the range. `noise` in metres at 1 m.
inline ScanSet scan_room(const AnalyticRoom& room, const std::vector<Vector3d>& origins, double noise,
                         uint64_t seed, double highest_pitch = 0.35) {
  ScanSet set;
  set.sensor = "synthetic";
  set.range_max = 6;
  const Random random(seed);
  for (size_t i = 0; i < origins.size(); ++i) {
    Random own = random.fork(i);
    Scan scan;
    scan.name = "scan_" + std::to_string(i);
    scan.map_from_scan.translation() = origins[i];
    scan.origins.emplace_back(0.F, 0.F, 0.F);
    constexpr double kStep = 0.45 * kPi / 180;
    for (double pitch = -1.25; pitch < highest_pitch; pitch += kStep)
      for (double yaw = 0; yaw < 2 * kPi; yaw += kStep / std::cos(pitch)) {
        const Vector3d ray(std::cos(yaw) * std::cos(pitch) + 1e-9, std::sin(yaw) * std::cos(pitch) + 1e-9,
                           std::sin(pitch));
        const double range = room.cast(origins[i], ray);
        ScanPoint point;
        point.position = (ray * (range + own.normal(noise * range * range))).cast<float>();
        scan.points.push_back(point);
      }
    set.scans.push_back(std::move(scan));
  }
  return set;
}

inline const std::vector<Vector3d> kOrigins = {
    {0.8, 1.9, 1.5}, {2.0, 1.8, 1.5}, {3.2, 1.7, 1.5}, {3.3, 0.6, 1.5}, {0.7, 0.6, 1.5}};

}  // namespace loci::mapping::test
