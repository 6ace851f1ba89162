#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {

/// Height of a level surface: the median of the medians of its scans.
struct LevelHeight {
  double height = 0;
  double sd = 0;           ///< of the medians
  std::vector<int> scans;  ///< that count
};
/// Scans with fewer than `min_points` heights do not count; unset when none does.
std::optional<LevelHeight> level_height(const std::map<uint16_t, std::vector<double>>& heights_by_scan,
                                        size_t min_points);

/// The smallest rotation and shift along z that puts the floor at z = 0 with z up; x, y and yaw stay. The
/// floor is the largest plane whose normal is near `up_hint` (unit, map frame) with almost no points below
/// it. Unset when there is no such plane.
std::optional<Isometry3d> level_by_floor(const Surface& surface, const Vector3d& up_hint);

/// The same for the largest plane whose normal is near `up_hint`, whatever is below it.
std::optional<Isometry3d> level_by_largest_plane(const Surface& surface, const Vector3d& up_hint);

/// What a level plane is, as far as a depth camera's views of it tell.
struct Ground {
  bool is_floor = true;                ///< otherwise the top of a table or counter
  bool certain = true;                 ///< false: nothing in view decides, and the likelier is taken
  std::optional<double> floor_height;  ///< below a top, where the floor is in view beyond its edges
  std::string because;                 ///< a clause
};
/// `levelled` puts the plane at z = 0.
Ground ground_of(const Surface& surface, const Isometry3d& levelled);

/// Directions that may be up, most likely first: the map's z, then a depth camera's -y; otherwise y down and
/// y up, as in point clouds of cameras.
std::vector<Vector3d> up_hints(const ScanSet& scans);

/// The yaw in (-45°, 45°] of the room's main directions, from the normals of vertical surfaces; 0 without
/// any.
double room_yaw(const Surface& surface);

}  // namespace loci::mapping
