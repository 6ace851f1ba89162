#pragma once

#include <optional>

#include "mapping/interpretation/surface.h"

namespace loci::mapping {

/// The smallest rotation and shift along z that puts the floor at z = 0 with z up; x, y and yaw stay. The
/// floor is the largest plane that looks roughly along `up_hint` (unit, map frame) and has next to nothing
/// below it. Unset when there is none.
std::optional<Isometry3d> level_by_floor(const Surface& surface, const Vector3d& up_hint);

/// Directions that may be up, the likeliest first: a depth camera's -y; otherwise z of the map, then y down
/// and y up as point clouds of cameras have it.
std::vector<Vector3d> up_hints(const ScanSet& scans);

/// The yaw in (-45°, 45°] of the main directions of the room, from the normals of vertical surfaces; 0
/// without any.
double room_yaw(const Surface& surface);

}  // namespace loci::mapping
