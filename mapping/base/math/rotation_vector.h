#pragma once

#include <Eigen/Geometry>

#include "mapping/base/math/math.h"

namespace loci {

/// The rotation about a vector by its length in radians.
inline Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix()
                   : Eigen::Matrix3d::Identity();
}

/// The shortest such vector of a rotation.
inline Eigen::Vector3d vector_from_rotation(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  const double angle = turn.angle() > kPi ? turn.angle() - 2 * kPi : turn.angle();
  return angle * turn.axis();
}

}  // namespace loci
