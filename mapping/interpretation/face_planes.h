#pragma once

#include <vector>

#include "mapping/interpretation/surface.h"

namespace loci::mapping {

/// A vertical plane with coordinates of its own: u to the right as seen by who stands before it, v = z, and
/// depth out of it, metres. It is as large as pieces of surface lie in it without wide gaps.
struct Face {
  Vector2d normal = Vector2d::UnitX();  ///< horizontal, towards who sees it
  double offset = 0;                    ///< normal · (x, y) of its points
  double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
  double area = 0;  ///< seen, m²

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

/// Vertical planes, also small ones and such that stand askew, by sample consensus over small pieces of
/// surface: the strongest plane takes its pieces, then the next. Layers 3 cm apart are told apart.
std::vector<Face> find_faces(const Surface& surface, double floor_height);

}  // namespace loci::mapping
