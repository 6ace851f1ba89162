#include "mapping/interpretation/fronts/fixture_shape.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {

FixtureShape line_through(const std::vector<FixturePoint>& points, Random random) {
  FixtureShape best;
  for (int round = 0; round < 200; ++round) {
    const FixturePoint& a = points[random.index(points.size())];
    const FixturePoint& b = points[random.index(points.size())];
    const Vector2d along(b.u - a.u, b.v - a.v);
    if (along.norm() < 0.01) continue;
    const Vector2d across = Vector2d(-along.y(), along.x()).normalized();
    std::vector<size_t> inliers;
    for (size_t i = 0; i < points.size(); ++i)
      if (std::abs(across.dot(Vector2d(points[i].u - a.u, points[i].v - a.v))) < kFixtures.line_tolerance_m)
        inliers.push_back(i);
    if (inliers.size() > best.inliers.size()) best.inliers = std::move(inliers);
  }
  return best;
}

void measure_shape(const std::vector<FixturePoint>& points, FixtureShape& shape) {
  Vector2d mean = Vector2d::Zero();
  for (const size_t i : shape.inliers) mean += Vector2d(points[i].u, points[i].v);
  mean /= static_cast<double>(shape.inliers.size());
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const size_t i : shape.inliers) {
    const Vector2d d = Vector2d(points[i].u, points[i].v) - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  shape.axis = {std::cos(angle), std::sin(angle)};
  const Vector2d across(-shape.axis.y(), shape.axis.x());
  std::vector<double> along;
  std::vector<double> beside;
  for (const size_t i : shape.inliers) {
    const Vector2d d = Vector2d(points[i].u, points[i].v) - mean;
    along.push_back(shape.axis.dot(d));
    beside.push_back(across.dot(d));
  }
  const double low = quantile(along, 0.02);
  const double high = quantile(along, 0.98);
  const double left = quantile(beside, 0.05);
  const double right = quantile(beside, 0.95);
  shape.length = high - low;
  shape.width = (right - left) / 0.9;
  shape.centre = mean + (low + high) / 2 * shape.axis + (left + right) / 2 * across;
}

double mixture_depth(const std::vector<double>& depths, double start, double sigma) {
  double depth = start;
  double share = 0.5;
  for (int round = 0; round < 15; ++round) {
    double sum = 0;
    double weights = 0;
    for (const double d : depths) {
      const double before = share * std::exp(-0.5 * (d - depth) * (d - depth) / (sigma * sigma));
      const double face = (1 - share) * std::exp(-0.5 * d * d / (sigma * sigma)) + 1e-9;
      const double weight = before / (before + face);
      sum += weight * d;
      weights += weight;
    }
    if (weights < 1) break;
    depth = sum / weights;
    share = std::clamp(weights / static_cast<double>(depths.size()), 0.05, 0.95);
  }
  return depth;
}

}  // namespace loci::mapping
