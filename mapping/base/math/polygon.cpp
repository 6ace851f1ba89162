#include "mapping/base/math/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace loci {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double signed_area(const Polygon& polygon) {
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i)
    twice += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
  return twice / 2;
}

}  // namespace

double area_of(const Polygon& polygon) {
  return std::abs(signed_area(polygon));
}

bool contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  for (size_t i = 0; i < polygon.size() && polygon.size() > 2; ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

double distance_to_edge(const Polygon& polygon, const Eigen::Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const Eigen::Vector2d side = b - a;
    const double t = std::clamp((point - a).dot(side) / std::max(side.squaredNorm(), 1e-12), 0.0, 1.0);
    nearest = std::min(nearest, (a + t * side - point).norm());
  }
  return nearest;
}

double shared_area(const Polygon& a, const Polygon& b) {
  const double inside = signed_area(b) < 0 ? -1 : 1;
  Polygon left = a;
  for (size_t side = 0; side < b.size(); ++side) {
    const Eigen::Vector2d& start = b[side];
    const Eigen::Vector2d along = b[(side + 1) % b.size()] - start;
    const Polygon uncut = std::move(left);
    left.clear();
    for (size_t i = 0; i < uncut.size(); ++i) {
      const Eigen::Vector2d &p = uncut[i], &q = uncut[(i + 1) % uncut.size()];
      const double of_p = inside * cross(along, p - start), of_q = inside * cross(along, q - start);
      if (of_p >= 0) left.push_back(p);
      if ((of_p > 0 && of_q < 0) || (of_p < 0 && of_q > 0))
        left.push_back(p + (q - p) * (of_p / (of_p - of_q)));
    }
  }
  return area_of(left);
}

}  // namespace loci
