#include "mapping/base/math/pose.h"

#include <cmath>

namespace loci {
namespace {

constexpr double kOrthonormalTolerance = 1e-2;

}  // namespace

Isometry3d pose_from_values(const std::array<double, 7>& values, const FileLocation& location) {
  for (const double value : values)
    if (!std::isfinite(value)) throw Error("the pose has a value that is not a finite number", location);
  const Eigen::Quaterniond rotation(values[6], values[3], values[4], values[5]);
  if (std::abs(rotation.norm() - 1) > kOrthonormalTolerance)
    throw Error("the pose's quaternion is not of unit length (" + std::to_string(rotation.norm()) + ")",
                location, "poses are x y z qx qy qz qw");
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() << values[0], values[1], values[2];
  return pose;
}

Isometry3d pose_from_matrix(const Eigen::Matrix4d& matrix, const FileLocation& location) {
  if (!matrix.allFinite()) throw Error("the pose has a value that is not a finite number", location);
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const double off = (linear.transpose() * linear - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > kOrthonormalTolerance || linear.determinant() < 0)
    throw Error("the pose's rotation is not orthonormal (off by " + std::to_string(off) + ")", location,
                "poses are 4x4 matrices, row by row, of a rigid motion");
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-6)
    throw Error("the pose's last row is not 0 0 0 1", location);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

std::array<double, 7> values_from_pose(const Isometry3d& pose) {
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const Vector3d t = pose.translation();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

std::array<double, 12> exact_values(const Isometry3d& pose) {
  std::array<double, 12> values;
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data()) = pose.affine();
  return values;
}

Isometry3d pose_from_exact(const std::array<double, 12>& values) {
  Isometry3d pose = Isometry3d::Identity();
  pose.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data());
  return pose;
}

Eigen::Matrix3d rotation_from_rpy(const Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

Vector3d rpy_from_rotation(const Eigen::Matrix3d& r) {
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  if (std::hypot(r(0, 0), r(1, 0)) < 1e-9)  // Gimbal lock: only roll ± yaw is determined.
    return {std::atan2(-r(1, 2), r(1, 1)), pitch, 0.0};
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

Eigen::Matrix3d rotation_between(const Vector3d& from, const Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

}  // namespace loci
