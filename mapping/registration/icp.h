#pragma once

#include "mapping/base/math/pose.h"
#include "mapping/registration/surfels.h"

namespace loci::mapping::registration {

enum class Metric { kPoint, kPlane, kGeneralised };

struct IcpOptions {
  Metric metric = Metric::kPlane;
  bool planar = true;      ///< x, y, yaw only
  double radius = 0.1;     ///< of the correspondence search, metres
  double sigma = 0.05;     ///< residuals of this size begin to lose weight, metres
  int iterations = 20;     ///< at most
  double accuracy = 1e-4;  ///< stops when a step moves less, metres (and radians at 1 m)
  size_t samples = 0;      ///< at most so many source surfels take part; 0 = all
};

struct IcpResult {
  Isometry3d target_from_source = Isometry3d::Identity();
  /// Of the sum of squared residuals at the end: x y z roll pitch yaw of a motion about the target's origin.
  Matrix6d hessian = Matrix6d::Zero();
  double rmse = 0;    ///< of the residuals, weighted, metres
  double weight = 0;  ///< sum of the weights of the correspondences
  double score = 0;   ///< weight over the largest that it could be, 0 to 1
  int iterations = 0;
};

/// Iterative closest point by Gauss-Newton with a redescending robust loss (Geman-McClure), between surfels
/// of one level. Source and target in upright frames when planar.
IcpResult icp(const Surfels& target, const Surfels& source, const Isometry3d& target_from_source,
              const IcpOptions& options);

}  // namespace loci::mapping::registration
