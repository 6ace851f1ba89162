#include "mapping/recording/gravity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math.h"
#include "mapping/base/text.h"

namespace loci::mapping {
namespace {

constexpr struct {
  size_t frames = 8;              ///< spread over the recording
  int columns = 120;              ///< points across an image
  double cone_deg = 50;           ///< how far up may be off the side of the image that is up
  double plane_deg = 8;           ///< normals of one plane
  double bin_m = 0.03;            ///< heights of one plane
  double min_share = 0.04;        ///< of all points that the largest level plane has
  double upright_preference = 2;  ///< people and robots hold cameras upright
  double roll = 0.15;             ///< and their horizon level: standard deviation, rad
  double turn = 0.02;             ///< of image axes that counts as none: mean square, rad²
  size_t max_seeds = 150;
} kUp;

struct OrientedPoint {
  Vector3d position, normal;
};

/// Points of a frame with normals that face the camera, in the frame of `pose`.
void add_points(const RgbdFrame& frame, const Isometry3d& pose, std::vector<OrientedPoint>& points) {
  const int step = std::max(1, frame.depth.cols / kUp.columns), arm = 2 * step;
  const auto point = [&](int u, int v) {
    return frame.camera.depth.unproject(u, v, static_cast<double>(frame.depth.at<float>(v, u)));
  };
  for (int v = arm; v + arm < frame.depth.rows; v += step)
    for (int u = arm; u + arm < frame.depth.cols; u += step) {
      const Vector3d centre = point(u, v);
      const Vector3d across = point(u + arm, v) - point(u - arm, v),
                     down = point(u, v + arm) - point(u, v - arm);
      const Vector3d normal = down.cross(across).normalized();
      // Not a number where depth is missing; arms that are long in depth cross an edge.
      const double reach = 0.05 + 0.1 * centre.z();
      if (!normal.allFinite() || std::abs(across.z()) > reach || std::abs(down.z()) > reach) continue;
      points.push_back({pose * centre, pose.linear() * (normal.dot(centre) < 0 ? normal : -normal)});
    }
}

/// The direction near `hint` that most normals have.
std::optional<Vector3d> normal_peak(const std::vector<OrientedPoint>& points, const Vector3d& hint) {
  const double cone = std::cos(kUp.cone_deg * kPi / 180), same = std::cos(kUp.plane_deg * kPi / 180);
  std::vector<Vector3d> normals;
  for (const OrientedPoint& each : points)
    if (each.normal.dot(hint) > cone) normals.push_back(each.normal);
  if (normals.empty()) return std::nullopt;
  Vector3d best = hint;
  size_t most = 0;
  const size_t stride = std::max<size_t>(1, normals.size() / kUp.max_seeds);
  for (size_t i = 0; i < normals.size(); i += stride) {
    const auto count = static_cast<size_t>(std::count_if(
        normals.begin(), normals.end(), [&](const Vector3d& n) { return n.dot(normals[i]) > same; }));
    if (count > most) {
      most = count;
      best = normals[i];
    }
  }
  for (int i = 0; i < 4; ++i) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& n : normals)
      if (n.dot(best) > same) sum += n;
    best = sum.normalized();
  }
  return best;
}

/// Share of the points on the largest plane with this normal.
double plane_share(const std::vector<OrientedPoint>& points, const Vector3d& normal) {
  const double same = std::cos(kUp.plane_deg * kPi / 180);
  std::map<int64_t, size_t> heights;
  for (const OrientedPoint& each : points)
    if (each.normal.dot(normal) > same) ++heights[std::lround(each.position.dot(normal) / kUp.bin_m)];
  size_t most = 0;
  for (const auto& [bin, count] : heights) {
    const auto next = heights.find(bin + 1);
    most = std::max(most, count + (next == heights.end() ? 0 : next->second));
  }
  return static_cast<double>(most) / static_cast<double>(points.size());
}

/// How cameras were held: directions of the image's axes in the frame of the points, one per frame.
struct ImageAxes {
  std::vector<Vector3d> x, y;

  void add(const Isometry3d& pose) {
    x.push_back(pose.linear().col(0));
    y.push_back(pose.linear().col(1));
  }
};

Vector3d mean(const std::vector<Vector3d>& directions) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& direction : directions) sum += direction;
  return sum / static_cast<double>(directions.size());
}

/// How much better than any other way of holding a camera it is that `up` is up, `vertical` the axis of the
/// images nearest to it and `level` the other one: the horizon is level in the images, and cameras turn about
/// the vertical more than they nod.
double holding(const Vector3d& up, const std::vector<Vector3d>& level,
               const std::vector<Vector3d>& vertical) {
  double roll = 0;
  for (const Vector3d& axis : level) roll += std::pow(axis.dot(up), 2) / static_cast<double>(level.size());
  const double pan = 1 - mean(level).squaredNorm() + kUp.turn,
               nod = 1 - mean(vertical).squaredNorm() + kUp.turn;
  return std::exp(-roll / (2 * kUp.roll * kUp.roll)) * pan / (pan + nod);
}

std::optional<Vector3d> up_of_points(const std::vector<OrientedPoint>& points, const ImageAxes& axes) {
  if (points.size() < 500) return std::nullopt;
  std::optional<Vector3d> best;
  double best_score = 0;
  for (const bool is_sideways : {false, true})
    for (const double sign : {-1.0, 1.0}) {
      const auto& vertical = is_sideways ? axes.x : axes.y;
      const Vector3d hint = sign * mean(vertical);
      if (hint.norm() < 1e-6) continue;
      const auto normal = normal_peak(points, hint.normalized());
      if (!normal) continue;
      const double share = plane_share(points, *normal);
      const bool is_upright = !is_sideways && sign < 0;
      const double score = share * holding(*normal, is_sideways ? axes.y : axes.x, vertical) *
                           (is_upright ? kUp.upright_preference : 1);
      if (share < kUp.min_share || score <= best_score) continue;
      best_score = score;
      best = normal;
    }
  return best;
}

}  // namespace

std::optional<Vector3d> find_up(const Recording& recording) {
  const bool posed = recording.info().frames_with_pose > 0;
  const size_t stride = std::max<size_t>(1, recording.size() / kUp.frames);
  std::vector<OrientedPoint> points;
  ImageAxes axes;
  for (size_t i = 0; i < recording.size(); i += posed ? stride : 1) {
    if (!posed && i >= kUp.frames) break;
    const RgbdFrame frame = recording.frame(i);
    if (posed && !frame.map_from_camera) continue;
    const Isometry3d pose = frame.map_from_camera.value_or(Isometry3d::Identity());
    add_points(frame, pose, points);
    axes.add(pose);
    if (posed) continue;
    if (const auto up = up_of_points(points, axes)) return up;
    points.clear();
    axes = {};
  }
  return posed ? up_of_points(points, axes) : std::nullopt;
}

Vector3d parse_direction(const std::string& text) {
  static const std::map<std::string, Vector3d> kAxes = {
      {"x", Vector3d::UnitX()},   {"y", Vector3d::UnitY()},   {"z", Vector3d::UnitZ()},
      {"-x", -Vector3d::UnitX()}, {"-y", -Vector3d::UnitY()}, {"-z", -Vector3d::UnitZ()}};
  if (const auto axis = kAxes.find(text); axis != kAxes.end()) return axis->second;
  const Error malformed(fmt::format("'{}' is no direction", text), {"", 0, "--up"},
                        "give x, y, z, -x, -y, -z, three numbers with commas, auto, or keep");
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) throw malformed;
  Vector3d direction;
  for (int i = 0; i < 3; ++i) {
    const std::string part = trimmed(parts[static_cast<size_t>(i)]);
    char* end = nullptr;
    direction[i] = std::strtod(part.c_str(), &end);
    if (part.empty() || *end != '\0' || !std::isfinite(direction[i])) throw malformed;
  }
  if (direction.norm() < 1e-9) throw malformed;
  return direction.normalized();
}

}  // namespace loci::mapping
