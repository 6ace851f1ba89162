#pragma once

#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::mapping::tracking {

/// What was measured between two poses, or (to = none) of one pose in the map.
struct PoseConstraint {
  static constexpr size_t kMap = SIZE_MAX;
  size_t from = kMap;  ///< number of a pose, or kMap
  size_t to = 0;
  Isometry3d from_from_to = Isometry3d::Identity();
  Matrix6d information =
      Matrix6d::Identity();  ///< of a small motion (translation, rotation) in the frame of `to`
};

/// The direction of gravity in one frame.
struct UpConstraint {
  size_t pose = 0;
  Vector3d up = Vector3d::UnitZ();  ///< unit, in the frame of the pose; it becomes z of the map
  double sigma_rad = 0.01;
};

/// The poses that agree best with all constraints (Ceres, Cauchy loss: a wrong constraint has little weight).
/// The first pose stays when no constraint refers to the map. Returns the largest shift of a pose, metres.
double optimise(std::vector<Isometry3d>& map_from_frames, const std::vector<PoseConstraint>& constraints,
                const std::vector<UpConstraint>& ups = {});

}  // namespace loci::mapping::tracking
