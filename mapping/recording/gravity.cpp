#include "mapping/recording/gravity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

/// `towards_up`: the mean over the frames of where the top of the image and its sides point.
std::optional<Vector3d> up_of_points(const std::vector<OrientedPoint>& points,
                                     const std::array<Vector3d, 4>& image_sides) {
  if (points.size() < 500) return std::nullopt;
  std::optional<Vector3d> best;
  double best_score = kUp.min_share;
  for (size_t side = 0; side < image_sides.size(); ++side) {
    if (image_sides[side].norm() < 1e-6) continue;
    const auto normal = normal_peak(points, image_sides[side].normalized());
    if (!normal) continue;
    const double score = plane_share(points, *normal) * (side == 0 ? kUp.upright_preference : 1);
    if (score <= best_score) continue;
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
  std::array<Vector3d, 4> sides = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (size_t i = 0; i < recording.size(); i += posed ? stride : 1) {
    if (!posed && i >= kUp.frames) break;
    const RgbdFrame frame = recording.frame(i);
    if (posed && !frame.map_from_camera) continue;
    const Isometry3d pose = frame.map_from_camera.value_or(Isometry3d::Identity());
    add_points(frame, pose, points);
    const Vector3d x = pose.linear().col(0), y = pose.linear().col(1);
    sides[0] -= y;
    sides[1] += x;
    sides[2] -= x;
    sides[3] += y;
    if (posed) continue;
    if (const auto up = up_of_points(points, sides)) return up;
    points.clear();
  }
  return posed ? up_of_points(points, sides) : std::nullopt;
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
