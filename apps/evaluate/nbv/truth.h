#pragma once

#include <vector>

#include "mapping/base/math/cell_index.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/render/ray_scene.h"
#include "mapping/sensor/laser.h"

namespace loci::apps::nbv_evaluation {

/// What there is to explore in a world, from the world itself: for evaluation only.
struct Truth {
  std::vector<Vector2d> places;  ///< where the robot can get, on a grid of `step` metres
  double step = 0;               ///< metres
  double voxel = 0;              ///< metres
  CellIndex surface{1 << 16};    ///< voxels of the surface that is seen from these places

  /// Share of the surface that a map knows: an occupied voxel in it or beside it (six neighbours).
  double coverage(const mapping::OccupancyMap& map) const;
};

struct TruthOptions {
  double step = 0.2;
  double robot_radius = 0.3;
  double voxel = 0.05;
  double range_max = 5;  ///< of the map: farther is not inserted
  int threads = 0;
};

/// Places are those that a disc of the robot's radius reaches from `inside` between 5 cm and the scanner's
/// height; the surface is what rays of the laser's tilts, all around, meet from any of them (1° apart). A
/// voxel counts that is met at least twice.
Truth find_truth(const mapping::RayScene& scene, const Vector2d& inside, const mapping::LaserModel& laser,
                 const TruthOptions& options);

}  // namespace loci::apps::nbv_evaluation
