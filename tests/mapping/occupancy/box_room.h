#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/sensor/laser.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

/// A room of axis-aligned boxes, and noiseless or noisy sweeps of it, worked out by hand: no renderer needed.
struct BoxRoom {
  Eigen::AlignedBox3d room{Vector3d(-2.5, -2, 0), Vector3d(2.5, 2, 2.6)};
  std::vector<Eigen::AlignedBox3d> furniture;

  static BoxRoom kitchen() {
    BoxRoom room;
    room.furniture = {{Vector3d(-2.5, 1.4, 0), Vector3d(1, 2, 0.9)},
                      {Vector3d(1.9, -2, 0), Vector3d(2.5, -0.8, 2)},
                      {Vector3d(-0.6, -1.2, 0.7), Vector3d(0.5, -0.4, 0.75)}};
    return room;
  }

  /// Distance to the first surface along a unit direction.
  double cast(const Vector3d& origin, const Vector3d& direction) const {
    double nearest = exit(room, origin, direction);
    for (const auto& box : furniture) nearest = std::min(nearest, entry(box, origin, direction));
    return nearest;
  }

  /// A sweep of `azimuths` × `tilts` rays over the full circle from a levelled pose of the scanner.
  Scan sweep(const Isometry3d& map_from_scan, int azimuths, int tilts, double range_max, double sigma,
             uint64_t seed, double opening_deg = 360) const {
    Scan scan;
    scan.map_from_scan = map_from_scan;
    scan.origins.emplace_back(0.F, 0.F, 0.F);
    Random random(seed);
    for (int t = 0; t < tilts; ++t)
      for (int a = 0; a < azimuths; ++a) {
        const double tilt = (-50 + 95.0 * t / (tilts - 1)) * kPi / 180;
        const double azimuth = (static_cast<double>(a) / azimuths - 0.5) * opening_deg * kPi / 180;
        const Vector3d ray(std::cos(tilt) * std::cos(azimuth), std::cos(tilt) * std::sin(azimuth),
                           std::sin(tilt));
        const double distance = cast(map_from_scan.translation(), map_from_scan.linear() * ray);
        ScanPoint point;
        point.returned = distance < range_max;
        point.position = (ray * (point.returned ? distance + random.normal(sigma) : range_max)).cast<float>();
        scan.points.push_back(point);
      }
    return scan;
  }

 private:
  static double entry(const Eigen::AlignedBox3d& box, const Vector3d& origin, const Vector3d& direction) {
    const Eigen::Array3d a = (box.min() - origin).array() / direction.array();
    const Eigen::Array3d b = (box.max() - origin).array() / direction.array();
    const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
    return in <= out && in > 0 ? in : std::numeric_limits<double>::infinity();
  }
  static double exit(const Eigen::AlignedBox3d& box, const Vector3d& origin, const Vector3d& direction) {
    const Eigen::Array3d a = (box.min() - origin).array() / direction.array();
    const Eigen::Array3d b = (box.max() - origin).array() / direction.array();
    return a.max(b).minCoeff();
  }
};

}  // namespace loci::mapping
