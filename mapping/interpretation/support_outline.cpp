#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math.h"
#include "mapping/interpretation/edge_position.h"
#include "mapping/interpretation/support_checks.h"

namespace loci::mapping {
namespace {

constexpr double kClearly = 0.04;  // of the area, by which another outline must be better than rectangles
constexpr double kCorner = 0.01;   // of the area, that each corner beyond four must be worth
constexpr double kSimpler = 0.03;  // of the area, by which a polygon must be better than a circle

struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0;
  double misfit = 1e9;  ///< root mean square, metres
};

std::vector<Vector2d> polygon_of(const Circle& circle) {
  constexpr int kCorners = 48;
  std::vector<Vector2d> corners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * kPi * i / kCorners;
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
  // A part of the edge is seen as a face, another from above only.
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

/// The boundary as a polygon with few corners, each side moved to where its edge was seen.
std::vector<Vector2d> straightened(const std::vector<Vector2d>& boundary, const PlaneEvidence& evidence) {
  constexpr double kMaxOff = 0.025;  // m
  std::vector<cv::Point2f> points, few;
  for (const Vector2d& at : boundary)
    points.emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()));
  cv::approxPolyDP(points, few, kMaxOff, true);
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

/// The box of a polygon in the support's axes becomes its only part.
void set_polygon(Support& support, const std::vector<Vector2d>& polygon) {
  Extent box{Vector2d::Constant(1e9), Vector2d::Constant(-1e9)};
  for (const Vector2d& corner : polygon) {
    const Vector2d at = support.map_from_axes().inverse() * corner;
    box = {box.min.cwiseMin(at), box.max.cwiseMax(at)};
  }
  support.parts = {box};
  support.polygon = polygon;
}

}  // namespace

void fit_outline(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster) {
  constexpr double kMaxMisfit = 0.025;  // m, of a circle
  Extent box = support.parts.front();
  for (const Extent& part : support.parts) box = {box.min.cwiseMin(part.min), box.max.cwiseMax(part.max)};
  const std::vector<Vector2d> boundary = raster.contour(box);
  if (boundary.size() < 20) return;
  const double rectangles = raster.score_of(support.outline());
  double wanted = rectangles + kClearly * support.area();
  Circle circle = circle_through(boundary);
  if (circle.misfit < kMaxMisfit && circle.radius > 0.1 && circle.radius < 1.5) {
    sharpen(circle, evidence);
    const double score = raster.score_of(polygon_of(circle));
    if (score > wanted) {
      set_polygon(support, polygon_of(circle));
      support.radius = circle.radius;
      wanted = score + kSimpler * support.area();
    }
  }
  const std::vector<Vector2d> polygon = straightened(boundary, evidence);
  if (polygon.size() < 3) return;
  // A rough sensor frays straight edges: many corners follow its noise.
  const double corners = std::max(0.0, static_cast<double>(polygon.size()) - 4);
  if (raster.score_of(polygon) < wanted + kCorner * corners * support.area()) return;
  set_polygon(support, polygon);
  support.radius = 0;
}

}  // namespace loci::mapping
