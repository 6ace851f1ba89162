#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping::test {

/// A box of furniture, in the furniture's frame: x outward, y to the left of someone who stands before it,
/// z up; the face lies in x = 0.
struct Part {
  Vector3d low, high;
  bool mirror = false;  ///< gives no returns
};

/// Furniture that stands in the open over a floor, seen by a level sensor as a tilting laser would.
struct Furniture {
  std::vector<Part> parts;
  Isometry3d map_from_furniture = Isometry3d::Identity();

  /// A panel of 2 cm whose face is in x = 0; u to the right as seen from before it.
  void add_panel(double u0, double u1, double v0, double v1, bool mirror = false) {
    parts.push_back({{-0.02, -u1, v0}, {0, -u0, v1}, mirror});
  }
  /// A cupboard behind panels.
  void add_body(double u0, double u1, double v0, double v1) {
    parts.push_back({{-0.5, -u1, v0}, {-0.02, -u0, v1}});
  }
  /// A level bar of 12 mm on two posts, its middle 3 cm before the face.
  void add_level_bar(double u, double v, double length) {
    parts.push_back({{0.024, -u - length / 2, v - 0.006}, {0.036, -u + length / 2, v + 0.006}});
    for (const double end : {-0.4, 0.4})
      parts.push_back(
          {{0, -u + end * length - 0.004, v - 0.004}, {0.024, -u + end * length + 0.004, v + 0.004}});
  }
  void add_upright_bar(double u, double v, double length) {
    parts.push_back({{0.024, -u - 0.006, v - length / 2}, {0.036, -u + 0.006, v + length / 2}});
    for (const double end : {-0.4, 0.4})
      parts.push_back(
          {{0, -u - 0.004, v + end * length - 0.004}, {0.024, -u + 0.004, v + end * length + 0.004}});
  }
  /// A square knob.
  void add_knob(double u, double v, double size = 0.03) {
    parts.push_back({{0, -u - 0.006, v - 0.006}, {0.02, -u + 0.006, v + 0.006}});
    parts.push_back({{0.02, -u - size / 2, v - size / 2}, {0.035, -u + size / 2, v + size / 2}});
  }
  Vector3d at(double u, double v, double depth = 0) const {
    return map_from_furniture * Vector3d(depth, -u, v);
  }

  /// Distance along a unit ray of the furniture's frame; infinity = nothing.
  double cast(const Vector3d& origin, const Vector3d& ray) const {
    double nearest = ray.z() < -1e-9 ? -origin.z() / ray.z() : std::numeric_limits<double>::infinity();
    bool mirror = false;
    for (const Part& part : parts) {
      double enter = 0;
      double leave = 1e9;
      for (int i = 0; i < 3; ++i) {
        const double a = (part.low[i] - origin[i]) / ray[i];
        const double b = (part.high[i] - origin[i]) / ray[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave && enter > 0 && enter < nearest) nearest = enter, mirror = part.mirror;
    }
    return mirror ? std::numeric_limits<double>::infinity() : nearest;
  }
};

/// Scans from `origins` in the furniture's frame, a ray every 0.25 degrees, ranges with 8 mm of noise.
inline ScanSet scan_furniture(const Furniture& furniture, const std::vector<Vector3d>& origins,
                              uint64_t seed) {
  ScanSet set;
  set.sensor = "synthetic";
  set.range_max = 10;
  const Random random(seed);
  for (size_t i = 0; i < origins.size(); ++i) {
    Random own = random.fork(i);
    Scan scan;
    scan.name = "scan_" + std::to_string(i);
    scan.map_from_scan = furniture.map_from_furniture * Eigen::Translation3d(origins[i]);
    scan.origins.emplace_back(0.F, 0.F, 0.F);
    constexpr double kStep = 0.25 * kPi / 180;
    for (double tilt = -0.87; tilt < 0.3; tilt += kStep)
      for (double azimuth = -0.9; azimuth < 0.9; azimuth += kStep) {
        const Vector3d ray(-std::cos(azimuth) * std::cos(tilt) + 1e-9,
                           std::sin(azimuth) * std::cos(tilt) + 1e-9, std::sin(tilt));
        const double range = furniture.cast(origins[i], ray);
        ScanPoint point;
        point.returned = range < set.range_max;
        const double measured = point.returned ? range + own.normal(0.008) : set.range_max;
        point.position = (ray * measured).cast<float>();
        scan.points.push_back(point);
      }
    set.scans.push_back(std::move(scan));
  }
  return set;
}

inline const std::vector<Vector3d> kStandpoints = {
    {1.2, 0.5, 1.25}, {1.4, 0.0, 1.25}, {1.2, -0.6, 1.25}, {1.9, 0.3, 1.25}, {1.6, -0.9, 1.25}};

}  // namespace loci::mapping::test
