#include "perception/annotators/segmentation/clustering/object_piece.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "mapping/base/math/math.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// Whether the walls of a piece face its middle (-1) or away from it (1).
void set_hollowness(Piece& piece, const Vector2f& mean, const PlaneCloud& cloud) {
  float facing = 0;
  float all = 0;
  for (const int i : piece.points) {
    const Vector2f normal = cloud.normals[static_cast<size_t>(i)].head<2>();
    const Vector2f out = cloud.points[static_cast<size_t>(i)].head<2>() - mean;
    if (!normal.allFinite()) continue;
    facing += normal.dot(out);
    all += normal.norm() * out.norm();
  }
  piece.facing_out = all > 0 ? facing / all : 0;
}

/// Where a point is seen from the viewpoint, and the point.
using Bearings = std::vector<std::pair<float, Vector2f>>;

/// The angle from `ahead` to the left.
float angle_of(const Vector2f& ahead, const Vector2f& to) {
  return std::atan2(ahead.x() * to.y() - ahead.y() * to.x(), ahead.dot(to));
}

/// From -2 to 2, grows with that angle and is found much faster.
float order_of_angle(const Vector2f& ahead, const Vector2f& to) {
  const float side = ahead.x() * to.y() - ahead.y() * to.x(), along = ahead.dot(to);
  const float part = side / std::max(std::abs(side) + std::abs(along), std::numeric_limits<float>::min());
  return along >= 0 ? part : std::copysign(2.0f, side) - part;
}

/// The rightmost and the leftmost point when 2 % on either side are left out, with their angles; reorders
/// the points so that those between stand between these two.
std::pair<Bearings::iterator, Bearings::iterator> without_tails(Bearings& seen, const Vector2f& viewpoint,
                                                                const Vector2f& ahead) {
  for (auto& [angle, p] : seen) angle = order_of_angle(ahead, p - viewpoint);
  const auto tail = static_cast<std::ptrdiff_t>(seen.size() / 50);
  const auto by_angle = [](const auto& a, const auto& b) { return a.first < b.first; };
  const auto first = seen.begin() + tail, last = seen.end() - 1 - tail;
  std::nth_element(seen.begin(), first, seen.end(), by_angle);
  if (last != first) std::nth_element(first + 1, last, seen.end(), by_angle);
  for (const auto& end : {first, last}) end->first = angle_of(ahead, end->second - viewpoint);
  return {first, last};
}

/// Convex hull of the points and of their reflection about the middle of the line between the outermost
/// points to the left and to the right as the camera sees them.
void set_footprint(Piece& piece, const PlaneCloud& cloud) {
  const size_t stride = std::max<size_t>(1, piece.points.size() / 2000);
  Bearings seen;
  Vector2f mean = Vector2f::Zero();
  for (size_t k = 0; k < piece.points.size(); k += stride) {
    const Vector2f p = cloud.points[static_cast<size_t>(piece.points[k])].head<2>();
    seen.emplace_back(0.0f, p);
    mean += p;
  }
  mean /= static_cast<float>(seen.size());
  piece.distance = (mean - cloud.viewpoint).norm();
  const Vector2f ahead = (mean - cloud.viewpoint).normalized();
  const auto [first, last] = without_tails(seen, cloud.viewpoint, ahead);
  const Vector2f middle = 0.5f * (first->second + last->second);
  std::vector<cv::Point2f> half;
  for (auto point = first; point <= last; ++point) half.emplace_back(point->second.x(), point->second.y());
  half = types::near_hull(half);
  std::vector<cv::Point2f> both = half;
  for (const cv::Point2f& p : half) both.emplace_back(2.0f * middle.x() - p.x, 2.0f * middle.y() - p.y);
  cv::convexHull(both, piece.footprint);
  piece.extent.setEmpty();
  std::vector<Eigen::Vector2d> corners;
  for (const cv::Point2f& p : piece.footprint) {
    piece.extent.extend(Vector2f(p.x, p.y));
    corners.push_back(Vector2f(p.x, p.y).cast<double>());
  }
  piece.outline = PolygonOutline(corners);
  piece.left = first->first;
  piece.right = last->first;
  piece.bearing = std::atan2(ahead.y(), ahead.x());
  set_hollowness(piece, mean, cloud);
}

}  // namespace

OutlineBand outline_band(const std::vector<Eigen::Vector3f>& cloud, const std::vector<int>& members,
                         const Eigen::Vector2f& viewpoint, float low, float high) {
  OutlineBand band;
  Bearings seen;
  Vector2f mean = Vector2f::Zero();
  for (const int i : members) {
    const Eigen::Vector3f& p = cloud[static_cast<size_t>(i)];
    if (p.z() < low || p.z() > high) continue;
    seen.emplace_back(0.0f, p.head<2>());
    mean += p.head<2>();
  }
  band.points = static_cast<int>(seen.size());
  if (seen.empty()) return band;
  mean /= static_cast<float>(seen.size());
  band.distance = (mean - viewpoint).norm();
  const Vector2f ahead = (mean - viewpoint).normalized();
  band.across = Vector2f(-ahead.y(), ahead.x());
  const auto [right, left] = without_tails(seen, viewpoint, ahead);
  band.width = band.distance * (left->first - right->first);
  band.middle = viewpoint + Eigen::Rotation2Df(0.5f * (left->first + right->first)) * (band.distance * ahead);
  return band;
}

void measure_area(Piece& piece, const PlaneCloud& cloud) {
  piece.area = 0;
  for (const int i : piece.points) piece.area += static_cast<double>(cloud.areas[static_cast<size_t>(i)]);
  piece.lab.setZero();
  if (!cloud.lab.empty())
    for (const int i : piece.points)
      piece.lab += lab_vector(cloud.lab[static_cast<size_t>(i)]) / static_cast<float>(piece.points.size());
  // What a pixel covers grows with the square of the distance, and so does the noise.
  const double focal_squared = cloud.camera.fx * cloud.camera.fy;
  piece.noise = std::max(1.0, piece.area / static_cast<double>(piece.points.size()) * focal_squared);
}

void measure_shape(Piece& piece, const PlaneCloud& cloud) {
  std::vector<float> heights;
  heights.reserve(piece.points.size());
  for (const int i : piece.points) heights.push_back(cloud.points[static_cast<size_t>(i)].z());
  std::tie(piece.bottom, piece.top) = quantiles(heights, 0.02, 0.98);
  set_footprint(piece, cloud);
}

Rod::Rod(const Piece& piece, const PlaneCloud& cloud) : height(piece.top) {
  const size_t stride = std::max<size_t>(1, piece.points.size() / 500);
  std::vector<cv::Point2f> seen;
  for (size_t k = 0; k < piece.points.size(); k += stride) {
    const Vector3f& p = cloud.points[static_cast<size_t>(piece.points[k])];
    seen.emplace_back(p.x(), p.y());
  }
  const cv::RotatedRect rect = cv::minAreaRect(seen);
  const bool wide = rect.size.width > rect.size.height;
  const float angle = (rect.angle + (wide ? 0.0f : 90.0f)) * std::numbers::pi_v<float> / 180;
  middle = {rect.center.x, rect.center.y};
  along = {std::cos(angle), std::sin(angle)};
  length = std::max(rect.size.width, rect.size.height);
  thickness = std::min(rect.size.width, rect.size.height);
}

bool Rod::is_rod() const {
  return length > 1.5f * thickness && thickness < 1.7f * height && height < 2.5f * thickness;
}

float Rod::gap_to(const Rod& other) const {
  float least = std::numeric_limits<float>::max();
  for (const float end : {-0.5f, 0.5f})
    for (const float other_end : {-0.5f, 0.5f})
      least = std::min(
          least,
          (middle + end * length * along - other.middle - other_end * other.length * other.along).norm());
  return least;
}

double plane_residual(const Piece& a, const Piece& b, const PlaneCloud& cloud) {
  constexpr size_t kSamples = 300;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::array<std::vector<Eigen::Vector3d>, 2> samples;
  for (size_t k = 0; k < 2; ++k) {
    const Piece& piece = k == 0 ? a : b;
    const size_t stride = std::max<size_t>(1, piece.points.size() / kSamples);
    for (size_t i = 0; i < piece.points.size(); i += stride)
      samples[k].push_back(cloud.points[static_cast<size_t>(piece.points[i])].cast<double>());
    for (const Eigen::Vector3d& p : samples[k]) mean += p / (2.0 * static_cast<double>(samples[k].size()));
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& of_piece : samples)
    for (const Eigen::Vector3d& p : of_piece)
      spread += (p - mean) * (p - mean).transpose() / static_cast<double>(of_piece.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  double worst = 0;
  for (const auto& of_piece : samples) {
    double sum = 0;
    for (const Eigen::Vector3d& p : of_piece) sum += std::pow(solver.eigenvectors().col(0).dot(p - mean), 2);
    worst = std::max(worst, std::sqrt(sum / static_cast<double>(of_piece.size())));
  }
  return worst;
}

double share_before(const Piece& a, const Piece& b, const PlaneCloud& cloud, double slack_m) {
  constexpr float kMinSlope = 0.5f;
  constexpr size_t kSamples = 100;
  const auto sampled = [&](const Piece& piece) {
    return std::max<size_t>(1, piece.points.size() / kSamples);
  };
  const auto slack = static_cast<float>(slack_m + 2 * depth_noise(1.0) * std::max(a.noise, b.noise));
  const Vector2f middle = a.extent.center();
  int before = 0;
  int judged = 0;
  for (size_t k = 0; k < a.points.size(); k += sampled(a)) {
    const auto i = static_cast<size_t>(a.points[k]);
    const Vector2f wall = cloud.points[i].head<2>();
    const Vector2f out = cloud.normals[i].head<2>();
    const bool is_outer_wall = out.norm() > kMinSlope && out.dot(wall - middle) > 0;
    for (size_t l = 0; l < b.points.size(); l += sampled(b), ++judged) {
      const Vector2f to = cloud.points[static_cast<size_t>(b.points[l])].head<2>() - wall;
      before += is_outer_wall && out.normalized().dot(to) > slack ? 1 : 0;
    }
  }
  return static_cast<double>(before) / judged;
}

}  // namespace loci::perception
