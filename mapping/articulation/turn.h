#pragma once

#include <vector>

#include "mapping/base/pose.h"

namespace loci::mapping {

/// How well measured orientations turn with a joint about `axis`.
struct TurnFit {
  Eigen::Quaterniond start = Eigen::Quaterniond::Identity();  ///< orientation at joint position 0
  std::vector<double> angles;                                 ///< radians off, per pose that counts
  double sigma = 0;                                           ///< per direction, robust
  double effective_poses = 0;                                 ///< errors of orientations hang together

  /// As of `poses` independent orientations with noise `noise` per direction (radians) and outliers.
  double log_likelihood(double noise, double poses) const;
};

/// Fits the orientation at joint position 0 robustly; poses of weight below one half do not count.
TurnFit fit_turn(const std::vector<Eigen::Quaterniond>& orientations, const Vector3d& axis,
                 const std::vector<double>& joint_positions, const std::vector<double>& weights);

}  // namespace loci::mapping
