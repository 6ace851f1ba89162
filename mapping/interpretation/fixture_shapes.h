#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/base/random.h"

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

/// A connected piece of the candidates' raster.
struct FixturePatch {
  cv::Rect cells;
  size_t cluster = 0;  ///< which it belongs to: its own number or that of a patch in line with it
};

/// The value below which a fraction of the values lies; there must be one.

/// Connected pieces of a raster by label; the first is the background.
std::vector<FixturePatch> patches_of(const cv::Mat& mask, cv::Mat& labels);

/// A bar may be hidden or missed in parts: thin patches in line with each other, a little apart, are one.
void join_in_line(std::vector<FixturePatch>& patches);

/// Sample consensus: the inliers of the line through most points.
FixtureShape line_through(const std::vector<FixturePoint>& points, Random random);

/// Centre, main axis, extents of the inliers.
void measure(const std::vector<FixturePoint>& points, FixtureShape& shape);

/// Depth of what stands before the face in a cluster whose rays partly pass it: a mixture of two normals,
/// the face's known.
double mixture_depth(const std::vector<double>& depths, double start, double sigma);

}  // namespace loci::mapping
