#include "perception/annotators/structure/pose_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/rotation_vector.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
namespace {

constexpr int kStride = 4;           ///< pixels between points
constexpr int kSteps = 12;           ///< at most
constexpr double kLastGate = 0.03;   ///< metres: what is further from the map at the end is not on it
constexpr double kOnSurface = 0.02;  ///< metres, plus twice the noise: the filter's own tolerance
constexpr double kSameNormal = 0.8;  ///< cosine
constexpr double kMinShare = 0.15;   ///< of the points on the map's surfaces, for a fit to mean anything
constexpr double kMinExplainedGain =
    0.02;  ///< more of the points explained, for the given pose to be given up
/// A direction is determined when a unit motion moves this share of the points (in the mean square) towards
/// or away from their surfaces: an error of the sensor in them is at most its tenfold along it.
constexpr double kDetermined = 0.01;

/// A measured point and the surface of the map behind its pixel; camera frame.
struct Pair {
  Vector3d point, normal;  ///< normal of the map
  double distance;         ///< of the point before the map's surface
  double noise;            ///< metres
};

class Fit {
 public:
  Fit(const cv::Mat& points, const cv::Mat& normals, const mapping::PinholeCamera& camera,
      const mapping::RenderScene& scene, int threads)
      : scene_(scene), threads_(threads), coarse_(subsampled(camera, kStride)) {
    for (int v = 0; v < coarse_.height; ++v)
      for (int u = 0; u < coarse_.width; ++u) {
        const Vector3d point = vector(points, v, u), normal = vector(normals, v, u);
        if (std::isnan(point.z())) continue;
        ++measured_;
        if (normal.allFinite())
          samples_.push_back({u, v, point, normal, coarse_.unproject(u, v, 1), depth_noise(point.z())});
      }
  }

  size_t measured() const { return measured_; }

  std::vector<Pair> pairs(const Isometry3d& map_from_camera) const {
    mapping::RenderOptions options;
    options.normals = true;
    const mapping::RenderedView view = scene_.render(coarse_, map_from_camera, options, threads_);
    std::vector<Pair> pairs;
    pairs.reserve(samples_.size());
    for (const Sample& sample : samples_) {
      const auto depth = static_cast<double>(view.depth.at<float>(sample.v, sample.u));
      if (std::isnan(depth)) continue;
      const cv::Vec3f& n = view.normal.at<cv::Vec3f>(sample.v, sample.u);
      const Vector3d normal(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
      if (normal.dot(sample.normal) < kSameNormal) continue;
      const double distance = normal.dot(sample.point - depth * sample.ray);
      pairs.push_back({sample.point, normal, distance, sample.noise});
    }
    return pairs;
  }

  /// Share of the points that lie on the map's surfaces.
  double explained(const std::vector<Pair>& pairs) const {
    const auto on = std::ranges::count_if(
        pairs, [](const Pair& pair) { return std::abs(pair.distance) <= kOnSurface + 2 * pair.noise; });
    return measured_ == 0 ? 0 : static_cast<double>(on) / static_cast<double>(measured_);
  }

 private:
  static Vector3d vector(const cv::Mat& image, int v, int u) {
    const auto& value = image.at<cv::Vec3f>(v * kStride, u * kStride);
    return to_vector(value);
  }

  /// A measured point and where it is in the coarse image.
  struct Sample {
    int u, v;
    Vector3d point, normal;
    Vector3d ray;  ///< through that pixel, z = 1
    double noise;
  };

  const mapping::RenderScene& scene_;
  int threads_;
  mapping::PinholeCamera coarse_;
  std::vector<Sample> samples_;  ///< those that have a normal
  size_t measured_ = 0;
};

/// The motion of the points that brings them onto the map, about their middle, along what they determine.
struct Step {
  Isometry3d motion = Isometry3d::Identity();
  double length = 0;    ///< how far it moves a point at the usual distance from the middle
  int constrained = 0;  ///< directions
};

Step step_of(const std::vector<Pair>& pairs, double gate) {
  std::vector<double> weights;
  weights.reserve(pairs.size());
  Vector3d middle = Vector3d::Zero();
  double total = 0;
  for (const Pair& pair : pairs) {
    const double reach = gate + 2 * pair.noise, r = pair.distance / reach, far = 1 - r * r;
    const double sigma = 0.005 + pair.noise;
    weights.push_back(far <= 0 ? 0 : far * far / (sigma * sigma));
    middle += weights.back() * pair.point;
    total += weights.back();
  }
  if (total <= 0) return {};
  middle /= total;
  double size = 0;
  for (size_t i = 0; i < pairs.size(); ++i) size += weights[i] * (pairs[i].point - middle).squaredNorm();
  size = std::sqrt(size / total);
  if (!(size > 0.05)) return {};
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double w = weights[i] / total;
    if (w <= 0) continue;
    const Pair& pair = pairs[i];
    Vector6d row;
    row << pair.normal, (pair.point - middle).cross(pair.normal) / size;
    const Vector6d weighted = w * row;
    hessian.noalias() += weighted * row.transpose();
    gradient -= pair.distance * weighted;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(hessian);
  Vector6d motion = Vector6d::Zero();
  Step step;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] < kDetermined) continue;
    const Vector6d direction = solver.eigenvectors().col(i);
    motion += direction * (direction.dot(gradient) / solver.eigenvalues()[i]);
    ++step.constrained;
  }
  step.motion.linear() = rotation_from_vector(motion.tail<3>() / size);
  step.motion.translation() = motion.head<3>() + middle - step.motion.linear() * middle;
  step.length = motion.norm();
  return step;
}

double turn_deg(const Isometry3d& a, const Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / kPi;
}

}  // namespace

void PoseRefinementOptions::declare(OptionTable& table) {
  table.flag("refine_pose", refine_pose, "Refines the camera pose against the map first.");
  table.number("pose_error_m", pose_error_m, "m", "Maximum error of the given position.", 0.001, 1);
  table.number("pose_error_deg", pose_error_deg, "deg", "Maximum error of the given orientation.", 0.01, 30);
}

PoseRefinement refine_pose(const cv::Mat& points, const cv::Mat& normals,
                           const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                           const mapping::RenderScene& scene, const PoseRefinementOptions& options,
                           int threads) {
  const Fit fit(points, normals, camera, scene, threads);
  PoseRefinement result;
  result.map_from_camera = map_from_camera;
  std::vector<Pair> pairs = fit.pairs(map_from_camera);
  result.explained_before = result.explained_after = fit.explained(pairs);
  // Far from the camera a wrong orientation moves points more than a wrong position.
  double gate = options.pose_error_m + std::sin(options.pose_error_deg * kPi / 180) * 2;
  Isometry3d pose = map_from_camera;
  for (int i = 0; i < kSteps; ++i) {
    if (static_cast<double>(pairs.size()) < kMinShare * static_cast<double>(fit.measured()) ||
        pairs.size() < 100) {
      result.verdict = "too little of the map is in view";
      return result;
    }
    const Step step = step_of(pairs, gate);
    result.constrained = step.constrained;
    pose.matrix() = (pose * step.motion).matrix();
    if (gate <= kLastGate && step.length < 2e-4) break;
    gate = std::max(0.6 * gate, kLastGate);
    pairs = fit.pairs(pose);
  }
  pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  const double explained = fit.explained(fit.pairs(pose));
  const double shift = (pose.translation() - map_from_camera.translation()).norm();
  const double turn = turn_deg(map_from_camera, pose);
  if (explained < kMinShare) {
    result.verdict = "the image does not fit the map";
  } else if (explained < result.explained_before + kMinExplainedGain) {
    result.verdict = "the given pose explains as much";
  } else if (shift > 1.5 * options.pose_error_m || turn > 1.5 * options.pose_error_deg) {
    result.verdict = fmt::format("the map would be {:.0f} cm and {:.1f}° away", 100 * shift, turn);
  } else {
    result.map_from_camera = pose;
    result.moved = true;
    result.explained_after = explained;
    result.shift_m = shift;
    result.turn_deg = turn;
    result.verdict = fmt::format("moved by {:.1f} cm and {:.2f}°", 100 * shift, turn);
  }
  if (result.constrained < 6)
    result.verdict += fmt::format("; {} of 6 directions are not determined and stay", 6 - result.constrained);
  return result;
}

}  // namespace loci::perception
