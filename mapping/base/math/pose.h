#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>

#include "mapping/base/error.h"

namespace loci {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
/// Over the six parameters of a rigid motion.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Positions of joints by name, metres or radians; a joint that is not named is at 0.
using JointState = std::map<std::string, double>;

/// A pose from `x y z qx qy qz qw`. The quaternion is normalised when its length is within 1e-2 of one;
/// otherwise, and for values that are not finite, Error at `location`.
Isometry3d pose_from_values(const std::array<double, 7>& values, const FileLocation& location = {});

/// A pose from a 4x4 matrix. A rotation that is off orthonormal by less than 1e-2 is re-orthonormalised
/// (nearest rotation in the Frobenius norm); otherwise, and for values that are not finite, Error at
/// `location`.
Isometry3d pose_from_matrix(const Eigen::Matrix4d& matrix, const FileLocation& location = {});

/// `x y z qx qy qz qw` with qw >= 0.
std::array<double, 7> values_from_pose(const Isometry3d& pose);

/// The upper three rows of a pose's matrix, row by row: unlike through a quaternion (values_from_pose()),
/// every bit comes back. For checkpoints.
std::array<double, 12> exact_values(const Isometry3d& pose);
Isometry3d pose_from_exact(const std::array<double, 12>& values);

/// Fixed-axis roll, pitch, yaw (URDF): R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Matrix3d rotation_from_rpy(const Vector3d& rpy);
Vector3d rpy_from_rotation(const Eigen::Matrix3d& rotation);
/// The smallest rotation that turns one direction (of any length) into another.
Eigen::Matrix3d rotation_between(const Vector3d& from, const Vector3d& to);

}  // namespace loci
