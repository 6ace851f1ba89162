#include "mapping/articulation/joint_fit.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>

#include "mapping/articulation/parameters.h"
#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using View3 = Eigen::Map<const Vector3<T>>;

/// A point or a direction (`shifts` false) after the joint moved by q.
template <typename T>
Vector3<T> moved(ArticulationType type, const T* axis, const T* origin, const T& q, const Vector3<T>& p,
                 bool shifts) {
  const View3<T> a(axis);
  if (type == ArticulationType::prismatic) return shifts ? Vector3<T>(p + q * a) : p;
  const T turn[3] = {q * a.x(), q * a.y(), q * a.z()};
  const View3<T> o(origin);
  const Vector3<T> arm = shifts ? Vector3<T>(p - o) : p;
  Vector3<T> turned;
  ceres::AngleAxisRotatePoint(turn, arm.data(), turned.data());
  return shifts ? Vector3<T>(o + turned) : turned;
}

/// A pose of the hand against its first pose, moved by the joint.
struct HandResidual {
  ArticulationType type;
  Isometry3d pose;
  double position_sigma, turn_sigma;

  template <typename T>
  bool operator()(const T* axis, const T* origin, const T* q, const T* grip, const T* grip_turn,
                  T* residual) const {
    const Vector3<T> at = moved<T>(type, axis, origin, *q, View3<T>(grip), true);
    Eigen::Map<Vector3<T>> shift(residual), turn(residual + 3);
    shift = (at - pose.translation().cast<T>()) / T(position_sigma);
    // Orientation: R(q) · R(grip) = pose.
    Eigen::Matrix<T, 3, 3> grip_rotation, error;
    ceres::AngleAxisToRotationMatrix(grip_turn, grip_rotation.data());
    for (int k = 0; k < 3; ++k) {
      const Vector3<T> column = grip_rotation.col(k);
      error.col(k) = pose.linear().transpose().cast<T>() * moved<T>(type, axis, origin, *q, column, false);
    }
    ceres::RotationMatrixToAngleAxis(error.data(), turn.data());
    turn /= T(turn_sigma);
    return true;
  }
};

/// The closed face, moved, against the open one.
struct FaceResidual {
  ArticulationType type;
  FittedPlane closed, open;
  Vector3d centre;
  double tilt_sigma, offset_sigma;

  template <typename T>
  bool operator()(const T* axis, const T* origin, const T* q, T* residual) const {
    const Vector3<T> at = moved<T>(type, axis, origin, *q, centre.cast<T>(), true);
    const Vector3<T> normal = moved<T>(type, axis, origin, *q, closed.normal.cast<T>(), false);
    residual[0] = (open.normal.cast<T>().dot(at) - T(open.offset)) / T(offset_sigma);
    Eigen::Map<Vector3<T>> tilt(residual + 1);
    tilt = normal.cross(open.normal.cast<T>()) / T(tilt_sigma);
    return true;
  }
};

/// Prior of axis and hinge; fixes the origin along the axis.
struct PriorResidual {
  Vector3d axis_, origin_, face_normal;
  double face_offset;
  bool hinge;

  template <typename T>
  bool operator()(const T* axis, const T* origin, T* residual) const {
    Eigen::Map<Vector3<T>> tilt(residual);
    tilt = View3<T>(axis).cross(axis_.cast<T>()) / T(kJointFit.axis_sd);
    const View3<T> o(origin);
    residual[3] = axis_.cast<T>().dot(o - origin_.cast<T>()) / T(0.01);
    const T behind = T(face_offset) - face_normal.cast<T>().dot(o);
    residual[4] = hinge ? T((behind - T(kFaceMotion.hinge_depth_m)) / T(kJointFit.hinge_depth_sd_m)) : T(0);
    return true;
  }
};

struct Variables {
  std::array<double, 3> axis, origin, grip, grip_turn;
  std::vector<double> positions;  ///< of the joint, per pose of the hand; the last one is where it was seen
};

Variables variables_for(const Motion& start, const std::vector<Isometry3d>& hand) {
  Variables v;
  Eigen::Map<Vector3d>(v.axis.data()) = start.axis;
  Eigen::Map<Vector3d>(v.origin.data()) = start.origin;
  const size_t count = std::max<size_t>(hand.size(), 1);
  for (size_t i = 0; i < count; ++i)
    v.positions.push_back(count == 1
                              ? start.position
                              : start.position * static_cast<double>(i) / static_cast<double>(count - 1));
  if (hand.empty()) return v;
  Eigen::Map<Vector3d>(v.grip.data()) = hand.front().translation();
  const Eigen::AngleAxisd turn(hand.front().linear());
  Eigen::Map<Vector3d>(v.grip_turn.data()) = turn.angle() * turn.axis();
  return v;
}

HandResidual hand_residual(const Motion& start, const MotionEvidence& evidence, size_t pose,
                           double noise_scale) {
  return {start.type, evidence.hand_path[pose], noise_scale * evidence.hand_position_sigma_m,
          noise_scale * evidence.hand_orientation_sigma_deg * kDegree};
}

/// Robust root mean square of the hand's residuals in units of its noise.
double hand_rms(const Motion& start, const MotionEvidence& evidence, const Variables& v) {
  std::vector<double> squares;
  for (size_t i = 0; i < evidence.hand_path.size(); ++i) {
    std::array<double, 6> r{};
    hand_residual(start, evidence, i, 1)(v.axis.data(), v.origin.data(), &v.positions[i], v.grip.data(),
                                         v.grip_turn.data(), r.data());
    squares.push_back(Eigen::Map<Eigen::Matrix<double, 6, 1>>(r.data()).squaredNorm());
  }
  return std::sqrt(median(std::move(squares)) /
                   5.35);  // Median of the squared norm of a normal vector with six components.
}

void solve(const Motion& start, const MotionEvidence& evidence, double noise_scale, Variables& v,
           Motion* result) {
  ceres::Problem problem;
  ceres::Manifold* on_sphere = new ceres::SphereManifold<3>;
  problem.AddParameterBlock(v.axis.data(), 3, on_sphere);
  problem.AddParameterBlock(v.origin.data(), 3);
  const std::vector<Isometry3d>& hand = evidence.hand_path;
  for (size_t i = 0; i < hand.size(); ++i)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<HandResidual, 6, 3, 3, 1, 3, 3>(
                                 new HandResidual(hand_residual(start, evidence, i, noise_scale))),
                             new ceres::HuberLoss(kJointFit.robust_sigmas * std::sqrt(6.0)), v.axis.data(),
                             v.origin.data(), &v.positions[i], v.grip.data(), v.grip_turn.data());
  if (!hand.empty()) problem.SetParameterBlockConstant(v.positions.data());
  if (hand.size() == 1 || !evidence.open) problem.AddParameterBlock(&v.positions.back(), 1);
  if (evidence.open)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<FaceResidual, 4, 3, 3, 1>(new FaceResidual{
                                 start.type, *evidence.closed, *evidence.open, evidence.face_centre,
                                 std::hypot(kJointFit.face_tilt_sd,
                                            std::hypot(evidence.closed->normal_sd, evidence.open->normal_sd)),
                                 kJointFit.face_offset_sd_m * std::sqrt(2.0)}),
                             nullptr, v.axis.data(), v.origin.data(), &v.positions.back());
  const bool hinge = start.type == ArticulationType::revolute && evidence.closed;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual, 5, 3, 3>(new PriorResidual{
                               evidence.expected_axis, start.origin,
                               evidence.closed ? evidence.closed->normal : Vector3d(Vector3d::UnitX()),
                               evidence.closed ? evidence.closed->offset : 0, hinge}),
                           nullptr, v.axis.data(), v.origin.data());
  // A drawer has no origin; a hinge has two coordinates across its axis (the third is fixed).
  if (start.type == ArticulationType::prismatic) problem.SetParameterBlockConstant(v.origin.data());

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 60;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!result || !summary.IsSolutionUsable()) return;  // the start stays

  result->axis = Eigen::Map<Vector3d>(v.axis.data()).normalized();
  result->origin = Eigen::Map<Vector3d>(v.origin.data());
  result->position = v.positions.back();
  ceres::Covariance::Options how;
  how.algorithm_type = ceres::DENSE_SVD;
  how.null_space_rank = -1;
  how.num_threads = 1;
  ceres::Covariance covariance(how);
  std::vector<std::pair<const double*, const double*>> blocks{{v.axis.data(), v.axis.data()}};
  if (start.type == ArticulationType::revolute) blocks.emplace_back(v.origin.data(), v.origin.data());
  if (!covariance.Compute(blocks, &problem)) return;
  // Of the unit vector itself: the tangent space of the sphere has a scale of its own.
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> tilt;
  covariance.GetCovarianceBlock(v.axis.data(), v.axis.data(), tilt.data());
  result->axis_sd_deg = std::sqrt(tilt.trace()) / kDegree;
  if (start.type != ArticulationType::revolute) return;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> place;
  covariance.GetCovarianceBlock(v.origin.data(), v.origin.data(), place.data());
  result->origin_sd_m = std::sqrt(std::max(place.trace() - result->axis.dot(place * result->axis), 0.0));
}

}  // namespace

Isometry3d Motion::moved_from_closed() const {
  Isometry3d motion = Isometry3d::Identity();
  if (type == ArticulationType::prismatic) motion.translation() = position * axis;
  if (type == ArticulationType::revolute) {
    motion.linear() = Eigen::AngleAxisd(position, axis).toRotationMatrix();
    motion.translation() = origin - motion.linear() * origin;
  }
  return motion;
}

Motion fit_motion(const Motion& start, const MotionEvidence& evidence) {
  Motion motion = start;
  if (start.type == ArticulationType::rigid) return motion;
  Variables variables = variables_for(start, evidence.hand_path);
  double noise_scale = 1;
  if (!evidence.hand_path.empty()) {
    solve(start, evidence, noise_scale, variables, nullptr);
    noise_scale = std::max(hand_rms(start, evidence, variables), 1.0);
  }
  solve(start, evidence, noise_scale, variables, &motion);
  if (motion.position < 0) {
    motion.position = -motion.position;
    motion.axis = -motion.axis;
  }
  return motion;
}

}  // namespace loci::mapping
