#pragma once

#include <limits>
#include <vector>

#include "mapping/occupancy/floor_grid.h"
#include "mapping/sensor/laser.h"

namespace loci::nbv {

/// Shortest paths of a robot to every cell of the floor.
struct Reachability {
  static constexpr float kUnreachable = std::numeric_limits<float>::infinity();

  std::vector<float> distance;  ///< path length per cell of the floor grid, metres
  std::vector<int32_t> parent;  ///< previous cell on the path; -1 = the start or unreachable
  std::vector<uint8_t> roomy;   ///< obstacles are farther than its radius from anywhere in the cell

  /// Whether the robot can drive there and stand on floor that was seen, in space that is known to be free.
  bool stands(const mapping::FloorGrid& floor, size_t cell) const {
    return distance[cell] < kUnreachable && roomy[cell] != 0 && floor.seen[cell] != 0 &&
           floor.clear[cell] != 0;
  }
};

/// Shortest paths (Dijkstra, eight neighbours, no cutting of corners) from the robot over the floor grid
/// dilated by the robot's radius. Paths lead over floor that was seen; within `blind_radius` of the robot,
/// where its scanner cannot see the floor, also over floor whose space above is known to be free. The robot's
/// own cell always counts as free. A path may pass closer to obstacles (by a part of a cell, the precision of
/// the grid) than the robot may stop.
Reachability shortest_paths(const mapping::FloorGrid& floor, const mapping::PlanarPose& robot,
                            double robot_radius, double blind_radius);

/// The corners of the path to a pose, each looking along the path, the pose itself last; empty = unreachable.
std::vector<mapping::PlanarPose> path_to(const mapping::FloorGrid& floor, const Reachability& reach,
                                         const mapping::PlanarPose& goal);

}  // namespace loci::nbv
