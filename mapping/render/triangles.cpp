#include "mapping/render/triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace loci::mapping::render_detail {
namespace {

/// The part of a polygon on the side `sign · z <= sign · limit`.
std::vector<Vector3d> clipped(const std::vector<Vector3d>& polygon, double limit, double sign) {
  std::vector<Vector3d> result;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a.z() - limit), db = sign * (b.z() - limit);
    if (da <= 0) result.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) result.push_back(a + (b - a) * (da / (da - db)));
  }
  return result;
}

}  // namespace

std::vector<Vector3d> between_heights(const std::vector<Vector3d>& polygon, double z_min, double z_max) {
  return clipped(clipped(polygon, z_max, 1), z_min, -1);
}

double distance_from_above(const std::vector<Vector3d>& polygon, const Vector2d& point) {
  double distance = std::numeric_limits<double>::infinity();
  bool left = true, right = true;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d a = polygon[i].head<2>(), b = polygon[(i + 1) % polygon.size()].head<2>();
    const Vector2d edge = b - a, to = point - a;
    const double side = edge.x() * to.y() - edge.y() * to.x();
    left = left && side >= 0;
    right = right && side <= 0;
    const double along = edge.squaredNorm() > 0 ? std::clamp(to.dot(edge) / edge.squaredNorm(), 0., 1.) : 0;
    distance = std::min(distance, (to - along * edge).norm());
  }
  // Upright polygons are lines from above: there only the distance to their edges counts.
  return left != right ? 0 : distance;
}

Vector3d nearest_of_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  return a + (ab * vb + ac * vc) / (va + vb + vc);
}

}  // namespace loci::mapping::render_detail
