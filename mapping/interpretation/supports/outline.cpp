#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/refinement.h"
#include "mapping/interpretation/supports/supports.h"

namespace loci::mapping {
namespace {

std::vector<double> sorted_bounds(const std::vector<Extent>& parts, int axis) {
  std::vector<double> bounds;
  for (const Extent& part : parts) {
    bounds.push_back(part.min[axis]);
    bounds.push_back(part.max[axis]);
  }
  std::sort(bounds.begin(), bounds.end());
  std::vector<double> merged;
  for (const double bound : bounds)
    if (merged.empty() || bound - merged.back() > kOutlines.same_end_m) merged.push_back(bound);
  merged.back() = bounds.back();
  return merged;
}

/// Drops corners that lie on a straight line.
std::vector<Vector2d> without_straight(const std::vector<Vector2d>& corners) {
  std::vector<Vector2d> kept;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector2d before = corners[i] - corners[(i + corners.size() - 1) % corners.size()];
    const Vector2d after = corners[(i + 1) % corners.size()] - corners[i];
    if (std::abs(before.x() * after.y() - before.y() * after.x()) > 1e-9) kept.push_back(corners[i]);
  }
  return kept;
}

/// The outer boundary, counter-clockwise, of a union of rectangles in their axes.
std::vector<Vector2d> union_outline(const std::vector<Extent>& parts) {
  const std::vector<double> xs = sorted_bounds(parts, 0);
  const std::vector<double> ys = sorted_bounds(parts, 1);
  const int columns = static_cast<int>(xs.size()) - 1;
  const int rows = static_cast<int>(ys.size()) - 1;
  const auto filled = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= columns || j >= rows) return false;
    const auto x = static_cast<size_t>(i);
    const auto y = static_cast<size_t>(j);
    const Vector2d middle((xs[x] + xs[x + 1]) / 2, (ys[y] + ys[y + 1]) / 2);
    return std::any_of(parts.begin(), parts.end(), [&](const Extent& part) { return part.contains(middle); });
  };
  // Edges of filled cells against empty ones, with the filled cell on their left, chained from the first.
  std::multimap<std::pair<int, int>, std::pair<int, int>> next;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      if (!filled(i, j)) continue;
      if (!filled(i, j - 1)) next.emplace(std::pair(i, j), std::pair(i + 1, j));
      if (!filled(i + 1, j)) next.emplace(std::pair(i + 1, j), std::pair(i + 1, j + 1));
      if (!filled(i, j + 1)) next.emplace(std::pair(i + 1, j + 1), std::pair(i, j + 1));
      if (!filled(i - 1, j)) next.emplace(std::pair(i, j + 1), std::pair(i, j));
    }
  std::vector<Vector2d> corners;
  const auto start = next.begin()->first;
  for (auto at = start; !next.empty();) {
    const auto edge = next.find(at);
    if (edge == next.end()) break;
    corners.emplace_back(xs[static_cast<size_t>(at.first)], ys[static_cast<size_t>(at.second)]);
    at = edge->second;
    next.erase(edge);
    if (at == start) break;
  }
  return without_straight(corners);
}

}  // namespace

std::vector<Vector2d> Support::outline() const {
  if (!polygon.empty()) return polygon;
  std::vector<Vector2d> corners = union_outline(parts);
  for (Vector2d& corner : corners) corner = map_from_axes() * corner;
  return corners;
}

namespace {

struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0;
  double misfit = 1e9;  ///< root mean square, metres
};

std::vector<Vector2d> polygon_of(const Circle& circle) {
  std::vector<Vector2d> corners;
  for (int i = 0; i < kOutlines.circle_corners; ++i) {
    const double angle = 2 * kPi * i / kOutlines.circle_corners;
    corners.push_back(circle.centre + circle.radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

/// Least squares of x² + y² = 2 a x + 2 b y + c.
Circle circle_through(const std::vector<Vector2d>& boundary) {
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& point : boundary) mean += point / static_cast<double>(boundary.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Vector2d& point : boundary) {
    const Vector2d at = point - mean;
    const Vector3d row(2 * at.x(), 2 * at.y(), 1);
    normal += row * row.transpose();
    right += row * at.squaredNorm();
  }
  const Vector3d solution = normal.ldlt().solve(right);
  Circle circle;
  circle.centre = mean + solution.head<2>();
  circle.radius = std::sqrt(std::max(0.0, solution.z() + solution.head<2>().squaredNorm()));
  double squares = 0;
  for (const Vector2d& point : boundary)
    squares += std::pow((point - circle.centre).norm() - circle.radius, 2);
  circle.misfit = std::sqrt(squares / static_cast<double>(boundary.size()));
  return circle;
}

void sharpen(Circle& circle, const PlaneEvidence& evidence) {
  const EdgeSamples samples = samples_across(
      evidence, [&](const Vector2d& point) { return (point - circle.centre).norm() - circle.radius; });
  // About half of the edge is seen as a vertical face.
  const auto shift = edge_position(samples, kPi * circle.radius);
  if (shift) circle.radius += *shift;
}

/// A straight side of a polygon: normal · p = offset, normal outwards.
struct Line {
  Vector2d normal;
  double offset = 0;
};

std::optional<Vector2d> meeting(const Line& a, const Line& b) {
  Eigen::Matrix2d both;
  both << a.normal.transpose(), b.normal.transpose();
  if (std::abs(both.determinant()) < 0.2) return std::nullopt;
  return Vector2d(both.inverse() * Vector2d(a.offset, b.offset));
}

/// The boundary as a polygon with few corners, each side at its exact edge.
std::vector<Vector2d> straightened(const std::vector<Vector2d>& boundary, const PlaneEvidence& evidence) {
  std::vector<cv::Point2f> points, few;
  for (const Vector2d& at : boundary)
    points.emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()));
  cv::approxPolyDP(points, few, kOutlines.polygon_tolerance_m, true);
  if (few.size() < 3) return {};
  std::vector<Vector2d> corners;
  for (const cv::Point2f& at : few)
    corners.emplace_back(static_cast<double>(at.x), static_cast<double>(at.y));
  if (cv::contourArea(few, true) < 0) std::reverse(corners.begin(), corners.end());
  std::vector<Line> lines;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector2d start = corners[i];
    const Vector2d along = corners[(i + 1) % corners.size()] - start;
    const double length = along.norm();
    Line line{Vector2d(along.y(), -along.x()) / length, 0};
    line.offset = line.normal.dot(start);
    const EdgeSamples samples = samples_across(evidence, [&](const Vector2d& point) {
      const double at = along.dot(point - start) / length;
      return at < 0.02 || at > length - 0.02 ? 1e9 : line.normal.dot(point) - line.offset;
    });
    if (const auto shift = edge_position(samples, length); shift && length > 0.15) line.offset += *shift;
    lines.push_back(line);
  }
  std::vector<Vector2d> moved;
  for (size_t i = 0; i < corners.size(); ++i) {
    const auto corner = meeting(lines[(i + lines.size() - 1) % lines.size()], lines[i]);
    moved.push_back(corner && (*corner - corners[i]).norm() < 0.15 ? *corner : corners[i]);
  }
  return moved;
}

/// Sets the outline; the only part becomes the polygon's box in the support's axes.
void set_polygon(Support& support, const std::vector<Vector2d>& polygon) {
  Extent box = Extent::empty();
  for (const Vector2d& corner : polygon) box.extend(Vector2d(support.map_from_axes().inverse() * corner));
  support.parts = {box};
  support.polygon = polygon;
}

}  // namespace

void fit_outline(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster) {
  Extent box = support.parts.front();
  for (const Extent& part : support.parts) box.extend(part);
  const std::vector<Vector2d> boundary = raster.contour(box);
  if (boundary.size() < 20) return;
  const double rectangles = raster.score_of(support.outline());
  double min_score = rectangles + kOutlines.min_gain * support.area();
  Circle circle = circle_through(boundary);
  if (circle.misfit < kOutlines.max_circle_rms_m && circle.radius > 0.1 && circle.radius < 1.5) {
    sharpen(circle, evidence);
    const double score = raster.score_of(polygon_of(circle));
    if (score > min_score) {
      set_polygon(support, polygon_of(circle));
      support.radius = circle.radius;
      min_score = score + kOutlines.circle_gain * support.area();
    }
  }
  const std::vector<Vector2d> polygon = straightened(boundary, evidence);
  if (polygon.size() < 3) return;
  // Noise frays straight edges: a polygon with many corners follows it.
  const double corners = std::max(0.0, static_cast<double>(polygon.size()) - 4);
  if (raster.score_of(polygon) < min_score + kOutlines.corner_cost * corners * support.area()) return;
  set_polygon(support, polygon);
  support.radius = 0;
}

}  // namespace loci::mapping
