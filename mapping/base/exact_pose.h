#pragma once

#include <Eigen/Geometry>
#include <array>

namespace loci {

/// The upper three rows of a pose's matrix, row by row: unlike through a quaternion (values_from_pose()),
/// every bit comes back. For checkpoints.
inline std::array<double, 12> exact_values(const Eigen::Isometry3d& pose) {
  std::array<double, 12> values;
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data()) = pose.affine();
  return values;
}

inline Eigen::Isometry3d pose_from_exact(const std::array<double, 12>& values) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data());
  return pose;
}

}  // namespace loci
