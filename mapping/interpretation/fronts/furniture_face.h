#pragma once

#include "mapping/base/math/pose.h"

namespace loci::mapping {

/// A vertical plane of furniture. Coordinates: u to the right as seen by a person in front of it, v = z, and
/// depth out of it, metres. It extends over its pieces of surface up to wide gaps.
struct FurnitureFace {
  Vector2d normal = Vector2d::UnitX();  ///< horizontal, towards the observer
  double offset = 0;                    ///< normal · (x, y) of its points
  double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
  double area = 0;    ///< seen, m²
  bool wall = false;  ///< a piece of what was taken for a wall

  Vector2d right() const { return {-normal.y(), normal.x()}; }
  Vector3d normal3() const { return {normal.x(), normal.y(), 0}; }
  Vector3d right3() const { return {right().x(), right().y(), 0}; }
  /// From (u, v, depth) to the map.
  Vector3d at(double u, double v, double depth = 0) const {
    return (offset + depth) * normal3() + u * right3() + v * Vector3d::UnitZ();
  }
  /// From the map to (u, v, depth).
  Vector3d coordinates(const Vector3d& point) const {
    return {right3().dot(point), point.z(), normal3().dot(point) - offset};
  }
};

}  // namespace loci::mapping
