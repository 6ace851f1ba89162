#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping::testing {

/// A room of axis-aligned boxes that can be scanned: enough of a world to test registration against truth.
struct BoxRoom {
  struct Box {
    Vector3d low, high;
  };
  Box shell;               ///< seen from inside
  std::vector<Box> boxes;  ///< seen from outside

  /// Range along a unit direction, and no range when the ray leaves through an open shell.
  double range(const Vector3d& from, const Vector3d& direction) const {
    double nearest = leaving(shell, from, direction);
    for (const Box& box : boxes) nearest = std::min(nearest, entering(box, from, direction));
    return nearest;
  }

  static std::pair<double, double> crossing(const Box& box, const Vector3d& from, const Vector3d& direction) {
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    for (int k = 0; k < 3; ++k) {
      const double a = (box.low[k] - from[k]) / direction[k], b = (box.high[k] - from[k]) / direction[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return {enter, leave};
  }
  static double leaving(const Box& box, const Vector3d& from, const Vector3d& direction) {
    return crossing(box, from, direction).second;
  }
  static double entering(const Box& box, const Vector3d& from, const Vector3d& direction) {
    const auto [enter, leave] = crossing(box, from, direction);
    return enter < leave && enter > 0 ? enter : std::numeric_limits<double>::infinity();
  }
};

/// A kitchen-like room of 4.6 x 3.8 m without symmetry.
inline BoxRoom kitchen() {
  BoxRoom room;
  room.shell = {{-2.3, -1.9, 0}, {2.3, 1.9, 2.5}};
  room.boxes = {{{-2.3, 1.3, 0}, {0.9, 1.9, 0.9}},       // counter
                {{-2.3, 1.55, 1.4}, {-0.5, 1.9, 2.1}},   // wall cupboard
                {{1.65, 1.2, 0}, {2.3, 1.9, 2.0}},       // fridge
                {{-0.2, -1.2, 0.7}, {1.0, -0.4, 0.75}},  // table top
                {{-0.1, -1.1, 0}, {0.0, -1.0, 0.7}},     // its legs
                {{0.8, -0.6, 0}, {0.9, -0.5, 0.7}},     {{-2.3, -1.9, 0}, {-1.9, -0.7, 1.1}}};  // sideboard
  return room;
}

/// Another room of about the same size.
inline BoxRoom study() {
  BoxRoom room;
  room.shell = {{-2.1, -2.2, 0}, {2.4, 1.8, 2.5}};
  room.boxes = {{{-2.1, -0.6, 0}, {-1.3, 1.0, 0.74}},
                {{1.9, -2.2, 0}, {2.4, -0.2, 2.2}},
                {{-0.9, -2.2, 0}, {0.3, -1.7, 1.3}},
                {{0.6, 1.1, 0}, {1.5, 1.8, 0.5}}};
  return room;
}

/// A sweep from a scanner that stands level at x, y, yaw (1.25 m high), 180 degrees wide.
inline Scan sweep(const BoxRoom& room, double x, double y, double yaw, uint64_t seed, double step_deg = 0.75,
                  double range_max = 10) {
  Scan scan;
  scan.name = "scan_" + std::to_string(seed);
  scan.map_from_scan.translation() = Vector3d(x, y, 1.25);
  scan.map_from_scan.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  Random random(seed);
  const double step = step_deg * kPi / 180;
  for (double tilt = -50 * kPi / 180; tilt <= 45 * kPi / 180; tilt += step)
    for (double azimuth = -kPi / 2; azimuth <= kPi / 2; azimuth += step) {
      const Vector3d ray(std::cos(tilt) * std::cos(azimuth), std::cos(tilt) * std::sin(azimuth),
                         std::sin(tilt));
      const double range = room.range(scan.map_from_scan.translation(), scan.map_from_scan.linear() * ray);
      ScanPoint point;
      point.returned = range < range_max;
      point.position = (ray * (point.returned ? range + random.normal(0.008) : range_max)).cast<float>();
      scan.points.push_back(point);
    }
  return scan;
}

}  // namespace loci::mapping::testing
