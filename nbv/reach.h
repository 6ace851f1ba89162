#pragma once

#include <limits>
#include <vector>

#include "mapping/occupancy/floor_grid.h"
#include "mapping/sensor/laser.h"

namespace loci::nbv {

/// Where a robot can drive to, and how far that is.
struct Reach {
  static constexpr float kNever = std::numeric_limits<float>::infinity();

  std::vector<float> distance;  ///< metres of way per cell of the floor grid; kNever = no way
  std::vector<int32_t> parent;  ///< cell before it on the way; -1 = the start or no way
  std::vector<uint8_t> roomy;   ///< its radius fits wherever in its cell the nearest obstacle begins

  /// Whether the robot can go there and stand on floor that was seen, in space that is known to be free.
  bool stands(const mapping::FloorGrid& floor, size_t cell) const {
    return distance[cell] < kNever && roomy[cell] != 0 && floor.seen[cell] != 0 && floor.clear[cell] != 0;
  }
};

/// Shortest ways (Dijkstra, eight neighbours, no cutting of corners) from the robot over the floor grid
/// dilated by the robot's radius. The way leads over floor that was seen; within `blind_radius` of the robot,
/// where its scanner cannot see the floor, also over floor whose space above is known to be free. Where the
/// robot stands now it may stand, whatever the grid says. A way may pass closer to obstacles (by a part of a
/// cell, which is all that the grid knows of where they begin) than the robot may stop.
Reach find_ways(const mapping::FloorGrid& floor, const mapping::PlanarPose& robot, double robot_radius,
                double blind_radius);

/// The way to a pose as its corners, each looking along the way, the last one the pose itself; empty = none.
std::vector<mapping::PlanarPose> way_to(const mapping::FloorGrid& floor, const Reach& reach,
                                        const mapping::PlanarPose& goal);

}  // namespace loci::nbv
