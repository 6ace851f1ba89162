#pragma once

#include <cstdint>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/math/random.h"

namespace loci::mapping {

/// A point before a face.
struct FixturePoint {
  double u, v, depth;
  Vector2d toward;  ///< change of u, v per metre along the ray, towards the sensor
  double lean;      ///< change of depth per metre along the ray
  uint16_t scan;
};

/// The line or circle through a cluster.
struct FixtureShape {
  Vector2d centre = Vector2d::Zero();
  Vector2d axis = Vector2d::UnitX();
  double length = 0, width = 0;
  std::vector<size_t> inliers;
};

/// Sample consensus: the inliers of the line through most points.
FixtureShape line_through(const std::vector<FixturePoint>& points, Random random);

/// Centre, main axis, extents of the inliers.
void measure_shape(const std::vector<FixturePoint>& points, FixtureShape& shape);

/// Depth of the object before the face in a cluster some of whose rays pass it: a mixture of two normal
/// distributions, of which the face's is known.
double mixture_depth(const std::vector<double>& depths, double start, double sigma);

}  // namespace loci::mapping
