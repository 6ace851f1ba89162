#include "mapping/recording/gravity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/text.h"

namespace loci::mapping {
namespace {

constexpr struct {
  size_t frames = 24;             ///< spread over the recording
  size_t tries = 4;               ///< for each of them: frames may lack a pose
  int samples = 120;              ///< points along the longer side of an image
  double cone_deg = 50;           ///< how far up may be off the side of the image that is up
  double plane_deg = 8;           ///< normals of one plane
  double bin_m = 0.03;            ///< heights of one plane
  double min_share = 0.04;        ///< of all points that the largest level plane has
  double upright_preference = 2;  ///< people and robots hold cameras upright
  double roll = 0.15;             ///< and their horizon level: standard deviation, rad
  double tilt = 0.6;              ///< of cameras against the horizon, in the mean: standard deviation, rad
  double turn = 0.02;             ///< of image axes that counts as none: mean square, rad²
  double min_pan = 0.05;          ///< that tells the vertical without a plane: mean square, rad²
  double squared_deg = 12;        ///< by which normals of walls and level surfaces may be off
  double squared = 0.03;          ///< the same for their mean: standard deviation, rad
  double min_squared = 0.1;       ///< share of points on such surfaces that says anything
  double wall_evidence = 0.1;     ///< of a point on a wall, of that of one on the largest level plane
  size_t max_seeds = 150;
} kUp;

struct OrientedPoint {
  Vector3d position, normal;
};

/// Points of a frame with normals that face the camera, in the frame of `pose`.
void add_points(const RgbdFrame& frame, const Isometry3d& pose, std::vector<OrientedPoint>& points) {
  const int step = std::max(1, std::max(frame.depth.cols, frame.depth.rows) / kUp.samples), arm = 3 * step;
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
  const double cone = std::cos(kUp.cone_deg * kDegree), same = std::cos(kUp.plane_deg * kDegree);
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
  const double same = std::cos(kUp.plane_deg * kDegree);
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

/// A way of holding a camera: which axes of its images are level, and which point up.
struct Holding {
  const std::vector<Vector3d>& level;
  const std::vector<Vector3d>& vertical;
  double sign;  ///< of the vertical axes
  double preference;

  double roll(const Vector3d& up) const {
    double sum = 0;
    for (const Vector3d& axis : level) sum += std::pow(axis.dot(up), 2);
    return sum / static_cast<double>(level.size());
  }
  /// How much better this explains the axes than any other way of holding does, if `up` is up: the horizon is
  /// level in the images, and cameras turn about the vertical more than they nod.
  double probability(const Vector3d& up) const {
    const double pan = 1 - mean(level).squaredNorm() + kUp.turn,
                 nod = 1 - mean(vertical).squaredNorm() + kUp.turn;
    return preference * std::exp(-roll(up) / (2 * kUp.roll * kUp.roll)) * pan / (pan + nod);
  }
};

/// What is up near `hint`: all level axes are level, as are normals of walls, and surfaces that are level in
/// the room have it as their normal.
Vector3d upright(const Holding& held, const Vector3d& hint, const std::vector<OrientedPoint>& points) {
  const double same = std::cos(kUp.squared_deg * kDegree), level = std::sin(kUp.squared_deg * kDegree);
  Eigen::Matrix3d of_axes = (Eigen::Matrix3d::Identity() - hint * hint.transpose()) / (kUp.tilt * kUp.tilt);
  for (const Vector3d& axis : held.level)
    of_axes += axis * axis.transpose() / (kUp.roll * kUp.roll * static_cast<double>(held.level.size()));
  Eigen::Matrix3d squared = Eigen::Matrix3d::Zero();  // of the surfaces
  Vector3d up = hint;
  for (int i = 0; i < 6; ++i) {
    up = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(of_axes + squared).eigenvectors().col(0);
    if (up.dot(hint) < 0) up = -up;
    squared.setZero();
    double count = 0;
    for (const OrientedPoint& each : points) {
      const double along = std::abs(each.normal.dot(up));
      if (along > level && along < same) continue;
      squared += (along > same ? -1 : 1) * each.normal * each.normal.transpose();
      ++count;
    }
    if (count < kUp.min_squared * static_cast<double>(points.size())) return up;
    squared /= count * kUp.squared * kUp.squared;
  }
  return up;
}

/// Shares of the points: on walls, and on surfaces that face up.
struct Shares {
  double walls = 0, facing_up = 0;
};
Shares shares_of(const std::vector<OrientedPoint>& points, const Vector3d& up) {
  const double level = std::sin(kUp.plane_deg * kDegree), same = std::cos(kUp.plane_deg * kDegree);
  Shares shares;
  for (const OrientedPoint& each : points) {
    const double along = each.normal.dot(up);
    if (std::abs(along) < level) ++shares.walls;
    if (along > same) ++shares.facing_up;
  }
  shares.walls /= static_cast<double>(points.size());
  shares.facing_up /= static_cast<double>(points.size());
  return shares;
}

std::optional<Vector3d> up_of_points(const std::vector<OrientedPoint>& points, const ImageAxes& axes) {
  if (points.size() < 500) return std::nullopt;
  std::optional<Vector3d> best;
  double best_score = 0;
  for (const Holding& held :
       {Holding{axes.x, axes.y, -1, kUp.upright_preference}, Holding{axes.x, axes.y, 1, 1},
        Holding{axes.y, axes.x, -1, 1}, Holding{axes.y, axes.x, 1, 1}}) {
    const Vector3d side = held.sign * mean(held.vertical);
    if (side.norm() < 1e-6) continue;
    const auto judge = [&](const Vector3d& up, double level_share) {
      const double score =
          (level_share + kUp.wall_evidence * shares_of(points, up).walls) * held.probability(up);
      if (score <= best_score) return;
      best_score = score;
      best = up;
    };
    const auto normal = normal_peak(points, side.normalized());
    const double share = normal ? plane_share(points, *normal) : 0;
    if (share >= kUp.min_share) judge(*normal, share);
    // Where the camera turned far enough, how it was held says what is up without a large plane.
    if (1 - mean(held.level).squaredNorm() > kUp.min_pan) {
      const Vector3d up = upright(held, side.normalized(), points);
      judge(up, std::min(shares_of(points, up).facing_up, kUp.min_share));
    }
  }
  return best;
}

/// In the frame of the poses; without poses in that of the cameras.
std::optional<Vector3d> up_of(const std::vector<RgbdFrame>& frames) {
  std::vector<OrientedPoint> points;
  ImageAxes axes;
  for (const RgbdFrame& frame : frames) {
    const Isometry3d pose = frame.map_from_camera.value_or(Isometry3d::Identity());
    add_points(frame, pose, points);
    axes.add(pose);
  }
  return up_of_points(points, axes);
}

}  // namespace

std::optional<Vector3d> find_up(const Recording& recording) {
  const size_t size = recording.size(), parts = std::min(kUp.frames, size);
  if (recording.info().frames_with_pose == 0) {
    for (size_t i = 0; i < parts; ++i)
      if (auto up = up_of({recording.frame(i)})) return up;
    return std::nullopt;
  }
  std::vector<RgbdFrame> frames;
  for (size_t part = 0; part < parts; ++part) {
    const size_t begin = part * size / parts, end = (part + 1) * size / parts;
    const size_t stride = std::max<size_t>(1, (end - begin) / kUp.tries);
    for (size_t i = begin; i < end; i += stride) {
      RgbdFrame frame = recording.frame(i);
      if (!frame.map_from_camera) continue;
      frame.color.release();
      frames.push_back(std::move(frame));
      break;
    }
  }
  return up_of(frames);
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
