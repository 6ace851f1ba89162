#pragma once

#include <Eigen/Core>
#include <vector>

namespace loci {

/// Corners in order, either way round.
using Polygon = std::vector<Eigen::Vector2d>;

/// Area of a polygon that does not cross itself.
double area_of(const Polygon& polygon);

/// Whether a point lies in a polygon, by the edges that a ray from it crosses; none without three corners.
bool contains(const Polygon& polygon, const Eigen::Vector2d& point);
/// To the nearest edge, from either side of it; infinite without corners.
double distance_to_edge(const Polygon& polygon, const Eigen::Vector2d& point);

/// Area that two convex polygons share, by clipping one at each side of the other (Sutherland and Hodgman
/// 1974): also exact where sides coincide, for which OpenCV's intersectConvexConvex may answer 0.
double shared_area(const Polygon& a, const Polygon& b);

}  // namespace loci
