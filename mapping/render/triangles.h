#pragma once

#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::mapping::render_detail {

/// The part of a convex polygon between two heights; may be empty.
std::vector<Vector3d> between_heights(const std::vector<Vector3d>& polygon, double z_min, double z_max);

/// From a point to a convex polygon, both seen from above; 0 inside.
double distance_from_above(const std::vector<Vector3d>& polygon, const Vector2d& point);

/// The point of a triangle that is nearest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
Vector3d nearest_of_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c);

}  // namespace loci::mapping::render_detail
