#pragma once

#include <Eigen/Core>
#include <vector>

namespace loci {

/// Corners in order, either way round.
using Polygon = std::vector<Eigen::Vector2d>;

/// Area of a polygon that does not cross itself.
double area_of(const Polygon& polygon);

/// Area that two convex polygons share, by clipping one at each side of the other (Sutherland and Hodgman
/// 1974): also exact where sides coincide, for which OpenCV's intersectConvexConvex may answer 0.
double shared_area(const Polygon& a, const Polygon& b);

}  // namespace loci
