#include "mapping/tracking/alignment.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/rotation_vector.h"

namespace loci::mapping::tracking {
namespace {

using Vector8f = Eigen::Matrix<float, 8, 1>;
using Matrix8f = Eigen::Matrix<float, 8, 8>;

/// Sums over residuals: of rows (Jacobian, residual, 0), weighted. Blocks are summed in float, the whole in
/// double.
class NormalEquations {
 public:
  void add(const Vector8f& row, float weight) {
    const Vector8f weighted = weight * row;
    block_.noalias() += weighted * row.transpose();
    if (++in_block_ == 512) close_block();
  }
  void close_block() {
    total_ += block_.cast<double>();
    block_.setZero();
    in_block_ = 0;
  }
  Matrix6d hessian() const { return total_.topLeftCorner<6, 6>(); }
  Vector6d gradient() const { return total_.block<6, 1>(0, 6); }

 private:
  Matrix8f block_ = Matrix8f::Zero();
  Eigen::Matrix<double, 8, 8> total_ = Eigen::Matrix<double, 8, 8>::Zero();
  int in_block_ = 0;
};

Vector8f row_of(const Eigen::Vector3f& shift, const Eigen::Vector3f& turn, float residual) {
  Vector8f row;
  row << shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z(), residual, 0;
  return row;
}

/// What errors of the normals add to the information: a plane seems to hold a motion along itself.
class NormalNoise {
 public:
  void add(const Eigen::Vector3f& point, float weight) {
    weight_ += static_cast<double>(weight);
    first_ += (weight * point).cast<double>();
    second_ += (weight * point * point.transpose()).cast<double>();
  }
  Matrix6d information() const {
    Eigen::Matrix3d cross;
    cross << 0, -first_.z(), first_.y(), first_.z(), 0, -first_.x(), -first_.y(), first_.x(), 0;
    Matrix6d sum;
    sum << weight_ * Eigen::Matrix3d::Identity(), -cross, cross,
        second_.trace() * Eigen::Matrix3d::Identity() - second_;
    return kAlignment.normal_variance * sum;
  }

 private:
  double weight_ = 0;
  Vector3d first_ = Vector3d::Zero();
  Eigen::Matrix3d second_ = Eigen::Matrix3d::Zero();
};

/// Differences of intensity between a frame and a keyframe.
struct IntensitySum {
  size_t count = 0;
  double sum = 0, absolute = 0;  ///< the absolute ones without what the exposure explains
};

/// What one pass over the model points gives.
struct Pass {
  NormalEquations equations;
  NormalNoise noise;
  size_t compared = 0, inliers = 0;
  double squares = 0;
  std::vector<IntensitySum> intensities;  ///< by reference
};

/// The frame at one level, with cameras as floats.
struct Target {
  Target(const FrameImages& frame, size_t number)
      : level(frame.levels[number]),
        number_of_level(number),
        fx(static_cast<float>(level.depth_camera.fx)),
        fy(static_cast<float>(level.depth_camera.fy)),
        cx(static_cast<float>(level.depth_camera.cx)),
        cy(static_cast<float>(level.depth_camera.cy)),
        color_from_depth(frame.depth_from_color.inverse()),
        color_fx(static_cast<float>(level.color_camera.fx)),
        color_fy(static_cast<float>(level.color_camera.fy)),
        color_cx(static_cast<float>(level.color_camera.cx)),
        color_cy(static_cast<float>(level.color_camera.cy)) {}

  const ImageLevel& level;
  size_t number_of_level;
  float fx, fy, cx, cy;
  FloatMotion color_from_depth;
  float color_fx, color_fy, color_cx, color_cy;
};

float squared(float x) {
  return x * x;
}

/// Tukey's weight: nothing beyond the gate.
float tukey(float residual, float gate) {
  const float share = 1 - squared(residual / gate);
  return share > 0 ? share * share : 0;
}

enum class Match { outside, unmeasured, hidden, different, same };

/// Compares the depth at a model point: `point` and `normal` in the camera frame of the frame.
Match add_depth(const Target& target, const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                Pass& pass) {
  const ImageLevel& level = target.level;
  const float u = target.fx * point.x() / point.z() + target.cx,
              v = target.fy * point.y() / point.z() + target.cy;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(level.inverse_depth.cols - 1) &&
        v < static_cast<float>(level.inverse_depth.rows - 1)))
    return Match::outside;
  const int x = static_cast<int>(u + 0.5F), y = static_cast<int>(v + 0.5F);
  const float inverse = level.inverse_depth.at<float>(y, x);
  if (inverse <= 0) return Match::unmeasured;
  const float z = 1 / inverse;
  const float gate = kAlignment.gate_m[target.number_of_level] + kAlignment.gate_per_z2 * z * z;
  if (point.z() > z + 2 * gate) return Match::hidden;
  const cv::Vec3f& other = level.normals.at<cv::Vec3f>(y, x);
  if (other[2] == 0) return Match::unmeasured;
  ++pass.compared;
  const Eigen::Vector3f measured((static_cast<float>(x) - target.cx) / target.fx * z,
                                 (static_cast<float>(y) - target.cy) / target.fy * z, z);
  const float residual = normal.dot(measured - point);
  if (std::abs(residual) > gate ||
      normal.x() * other[0] + normal.y() * other[1] + normal.z() * other[2] < kAlignment.same_side_cosine)
    return Match::different;
  ++pass.inliers;
  pass.squares += static_cast<double>(residual * residual);
  const float slant = std::max(0.2F, -normal.dot(measured) / measured.norm());
  const float sigma2 = squared(static_cast<float>(kAlignment.disparity_sigma) * z * z * slant) +
                       squared(static_cast<float>(kAlignment.floor_sigma));
  const float weight = tukey(residual, gate) / sigma2;
  pass.equations.add(row_of(normal, measured.cross(normal), residual), weight);
  pass.noise.add(measured, weight);
  return Match::same;
}

/// Differences of intensity that say by how much a frame is brighter.
constexpr size_t kMinDifferences = 50;

/// The intensity, with its gradient, where a point in the frame of the colour camera is seen; false where it
/// is not, or where the image is saturated.
bool sample_intensity(const Target& target, const Eigen::Vector3f& seen, cv::Vec3f& sample) {
  if (seen.z() < 0.1F) return false;
  const Eigen::Vector2f pixel(target.color_fx * seen.x() / seen.z() + target.color_cx,
                              target.color_fy * seen.y() / seen.z() + target.color_cy);
  return interpolated(target.level.intensity, pixel, sample) && !is_saturated(sample[0]);
}

/// Compares the intensity at a model point, in the colour image, wherever that camera is. `bias`: by how much
/// the frame is brighter.
void add_intensity(const Target& target, const Eigen::Vector3f& point, float expected, float bias,
                   NormalEquations& equations, IntensitySum& sum) {
  const Eigen::Vector3f seen = target.color_from_depth * point;
  cv::Vec3f sample;
  if (!sample_intensity(target, seen, sample)) return;
  const float difference = sample[0] - expected;
  const float residual = difference - bias;
  if (std::abs(residual) > 2 * kAlignment.intensity_gate) return;
  ++sum.count;
  sum.sum += static_cast<double>(difference);
  sum.absolute += static_cast<double>(std::abs(residual));
  // Noise has slopes too, which would hold the pose where it is.
  if (squared(sample[1]) + squared(sample[2]) < squared(kAlignment.min_intensity_slope)) return;
  const float inverse = 1 / seen.z();
  const float gx = sample[1] * target.color_fx * inverse, gy = sample[2] * target.color_fy * inverse;
  const Eigen::Vector3f slope = target.color_from_depth.rotation.transpose() *
                                Eigen::Vector3f(gx, gy, -(gx * seen.x() + gy * seen.y()) * inverse);
  equations.add(row_of(-slope, slope.cross(point), residual),
                tukey(residual, kAlignment.intensity_gate) / squared(kAlignment.intensity_sigma));
}

/// By how much the frame is brighter than each keyframe, before it is aligned: cameras adapt their exposure.
std::vector<float> brightness_over(const Target& target, std::span<const Reference> references,
                                   const Isometry3d& map_from_camera) {
  std::vector<float> biases(references.size(), 0.0F);
  if (target.level.intensity.empty()) return biases;
  for (size_t i = 0; i < references.size(); ++i) {
    const Keyframe& keyframe = *references[i].keyframe;
    const FloatMotion transform(map_from_camera.inverse() * references[i].map_from_keyframe);
    std::vector<float> differences;
    cv::Vec3f sample;
    for (const ModelPoint& model : keyframe.points(std::min(target.number_of_level, keyframe.levels() - 1)))
      if (!std::isnan(model.intensity) &&
          sample_intensity(target, target.color_from_depth * (transform * model.position), sample))
        differences.push_back(sample[0] - model.intensity);
    if (differences.size() >= kMinDifferences) biases[i] = median(differences);
  }
  return biases;
}

Pass pass_over(const Target& target, std::span<const Reference> references, const Isometry3d& map_from_camera,
               const std::vector<float>& biases) {
  Pass pass;
  pass.intensities.resize(references.size());
  const bool colored = !target.level.intensity.empty();
  for (size_t i = 0; i < references.size(); ++i) {
    const Reference& reference = references[i];
    const FloatMotion transform(map_from_camera.inverse() * reference.map_from_keyframe);
    const size_t level = std::min(target.number_of_level, reference.keyframe->levels() - 1);
    for (const ModelPoint& model : reference.keyframe->points(level)) {
      const Eigen::Vector3f point = transform * model.position;
      if (point.z() < 0.1F) continue;
      const Match match = add_depth(target, point, transform.rotation * model.normal, pass);
      if (colored && (match == Match::same || match == Match::unmeasured) && !std::isnan(model.intensity))
        add_intensity(target, point, model.intensity, biases[i], pass.equations, pass.intensities[i]);
    }
  }
  pass.equations.close_block();
  return pass;
}

void update_biases(const Pass& pass, std::vector<float>& biases) {
  for (size_t i = 0; i < biases.size(); ++i)
    if (const IntensitySum& sum = pass.intensities[i]; sum.count >= kMinDifferences)
      biases[i] = static_cast<float>(sum.sum / static_cast<double>(sum.count));
}

Alignment result_of(const Pass& pass, const Isometry3d& pose) {
  Alignment result;
  result.map_from_camera = pose;
  result.hessian = pass.equations.hessian();
  result.information = (pass.equations.hessian() - pass.noise.information()) / kAlignment.correlation;
  result.compared = pass.compared;
  result.inliers = pass.inliers;
  if (pass.inliers > 0) result.rms = std::sqrt(pass.squares / static_cast<double>(pass.inliers));
  IntensitySum all;
  for (const IntensitySum& sum : pass.intensities) {
    all.count += sum.count;
    all.absolute += sum.absolute;
  }
  if (all.count > 0) result.intensity_error = all.absolute / static_cast<double>(all.count);
  return result;
}

/// The range of depths (m) around a pixel, as edges are known to a few pixels only; nothing without depth.
std::optional<std::pair<float, float>> depths_around(const cv::Mat& inverse_depth, const Vector2d& pixel) {
  constexpr int kRadius = 2;
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  float near = 0, far = 0;  // inverse
  for (int v = std::max(0, y - kRadius); v <= std::min(inverse_depth.rows - 1, y + kRadius); ++v)
    for (int u = std::max(0, x - kRadius); u <= std::min(inverse_depth.cols - 1, x + kRadius); ++u) {
      const float inverse = inverse_depth.at<float>(v, u);
      if (inverse <= 0) continue;
      near = std::max(near, inverse);
      far = far > 0 ? std::min(far, inverse) : inverse;
    }
  if (near <= 0) return std::nullopt;
  return std::pair(1 / near, 1 / far);
}

/// Points that a depth image shows, and those where it shows space instead.
struct SightCounts {
  double seen = 0, through = 0;

  /// A point in the camera frame of the depth image.
  void add(const Eigen::Vector3f& point, const PinholeCamera& camera, const cv::Mat& inverse_depth) {
    if (point.z() < 0.1F) return;
    const Vector2d pixel = camera.project(point.cast<double>());
    if (!camera.contains(pixel)) return;
    const auto depths = depths_around(inverse_depth, pixel);
    if (!depths) return;
    const auto [near, far] = *depths;
    const float gate = kAlignment.gate_m[1] + kAlignment.gate_per_z2 * far * far;
    if (point.z() < near - gate)
      ++through;
    else if (point.z() <= far + gate)
      ++seen;
  }
  double through_share() const { return through == 0 ? 0 : through / (through + seen); }
};

/// Some points of all surfaces: what has no normal is an edge or noise.
std::vector<Eigen::Vector3f> surfaces_of(const ImageLevel& level) {
  constexpr int kStride = 4;
  std::vector<Eigen::Vector3f> points;
  for (int v = kStride / 2; v < level.inverse_depth.rows; v += kStride)
    for (int u = kStride / 2; u < level.inverse_depth.cols; u += kStride) {
      if (level.normals.at<cv::Vec3f>(v, u)[2] == 0) continue;
      const double z = 1 / static_cast<double>(level.inverse_depth.at<float>(v, u));
      points.push_back(level.depth_camera.unproject(u, v, z).cast<float>());
    }
  return points;
}

}  // namespace

Isometry3d small_motion(const Vector6d& v) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = rotation_from_vector(v.tail<3>());
  motion.translation() = v.head<3>();
  return motion;
}

Vector6d vector_of(const Isometry3d& motion) {
  const Eigen::AngleAxisd turn(motion.linear());
  Vector6d v;
  v << motion.translation(), turn.angle() * turn.axis();
  return v;
}

std::optional<Matrix6d> Alignment::covariance() const {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information);
  if (!(solver.eigenvalues()[0] > 1e-6 * solver.eigenvalues()[5])) return std::nullopt;
  return solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() *
         solver.eigenvectors().transpose();
}

Alignment align(const FrameImages& frame, std::span<const Reference> references, const Isometry3d& guess,
                const LevelRange& levels, const PosePrior* prior) {
  Isometry3d pose = guess;
  const size_t coarsest = std::min(levels.coarsest, frame.levels.size() - 1);
  std::vector<float> biases = brightness_over(Target(frame, coarsest), references, guess);
  Pass pass;
  for (size_t level = coarsest + 1; level-- > levels.finest;) {
    const Target target(frame, level);
    for (int step = 0; step < kAlignment.max_steps[level]; ++step) {
      pass = pass_over(target, references, pose, biases);
      update_biases(pass, biases);
      Matrix6d hessian = pass.equations.hessian();
      hessian.diagonal() *= 1 + 1e-6;
      hessian.diagonal().array() += 1e-3;  // Where nothing determines the pose it stays.
      Vector6d gradient = pass.equations.gradient();
      if (prior != nullptr) {
        const Vector6d information = kAlignment.correlation * prior->sigma.cwiseAbs2().cwiseInverse();
        hessian.diagonal() += information;
        gradient += information.cwiseProduct(vector_of(prior->map_from_camera.inverse() * pose));
      }
      const Vector6d motion = -hessian.ldlt().solve(gradient);
      pose = pose * small_motion(motion);
      if (motion.head<3>().norm() < kAlignment.stop_translation &&
          motion.tail<3>().norm() < kAlignment.stop_rotation)
        break;
    }
  }
  pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return result_of(pass, pose);
}

Alignment compare(const FrameImages& frame, std::span<const Reference> references, const Isometry3d& pose,
                  size_t level) {
  const Target target(frame, std::min(level, frame.levels.size() - 1));
  return result_of(pass_over(target, references, pose, brightness_over(target, references, pose)), pose);
}

double overlap(const FrameImages& frame, const Reference& reference, const Isometry3d& map_from_camera) {
  const ImageLevel& level = frame.levels.front();
  const Isometry3d transform = map_from_camera.inverse() * reference.map_from_keyframe;
  const std::vector<ModelPoint>& points = reference.keyframe->points(reference.keyframe->levels() - 1);
  size_t seen = 0;
  for (const ModelPoint& model : points) {
    const Vector3d point = transform * model.position.cast<double>();
    if (point.z() < 0.1 || (transform.linear() * model.normal.cast<double>()).dot(point) >= 0) continue;
    const Vector2d pixel = level.depth_camera.project(point);
    if (!level.depth_camera.contains(pixel)) continue;
    const float inverse = level.inverse_depth.at<float>(static_cast<int>(std::lround(pixel.y())),
                                                        static_cast<int>(std::lround(pixel.x())));
    if (inverse > 0 &&
        std::abs(point.z() - 1 / static_cast<double>(inverse)) < 0.1 + 0.02 * point.z() * point.z())
      ++seen;
  }
  return points.empty() ? 0 : static_cast<double>(seen) / static_cast<double>(points.size());
}

double contradiction(const FrameImages& frame, std::span<const Reference> references,
                     const Isometry3d& map_from_camera) {
  const ImageLevel& level = frame.levels.front();
  const std::vector<Eigen::Vector3f> surfaces = surfaces_of(level);
  SightCounts of_keyframes, of_frame;
  for (const Reference& reference : references) {
    const Isometry3d motion = reference.map_from_keyframe.inverse() * map_from_camera;
    const FloatMotion to_keyframe(motion), to_frame(motion.inverse());
    const Keyframe& keyframe = *reference.keyframe;
    for (const Eigen::Vector3f& point : surfaces)
      of_keyframes.add(to_keyframe * point, keyframe.camera(), keyframe.inverse_depth());
    for (const ModelPoint& model : keyframe.points(0))
      of_frame.add(to_frame * model.position, level.depth_camera, level.inverse_depth);
  }
  return of_keyframes.through_share() + of_frame.through_share();
}

std::string misfit_of(const Alignment& alignment, double min_inliers) {
  if (alignment.compared < kVerdict.min_compared) return "too little of the model is in view";
  if (alignment.inlier_share() < min_inliers) return "the depth does not fit the model";
  if (alignment.intensity_error > kVerdict.max_intensity_error) return "the colours do not fit the model";
  return {};
}

bool is_determined(const Alignment& alignment) {
  const std::optional<Matrix6d> covariance = alignment.covariance();
  if (!covariance) return false;
  const auto largest = [&](Eigen::Index at) {
    return std::sqrt(
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Matrix3d(covariance->block<3, 3>(at, at)))
            .eigenvalues()[2]);
  };
  return largest(0) <= kVerdict.max_position_sigma && largest(3) <= kVerdict.max_rotation_sigma;
}

}  // namespace loci::mapping::tracking
