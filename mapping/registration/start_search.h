#pragma once

#include <vector>

#include "mapping/registration/prepared_scan.h"

namespace loci::mapping::registration {

/// How far the true pose may be from the guess, at most.
struct SearchWindow {
  double position = 0;  ///< metres
  double angle = 0;     ///< radians
};

/// The most promising poses within a window around a guess, best first: turns and shifts on a grid are scored
/// by how many coarse surfels of the source lie on ones of the target with agreeing normals (a correlative
/// search, Olson 2009). x, y, yaw when planar, otherwise all six. Poses beside `known`, where the guess
/// itself leads to, are left out, and so are those that score far less than it: when the guess was good, that
/// is nearly all, and the search costs little.
std::vector<Isometry3d> promising_starts(const PreparedScan& target, const PreparedScan& source,
                                         const Isometry3d& target_from_source, const SearchWindow& window,
                                         const Isometry3d& known, bool planar, size_t count);

}  // namespace loci::mapping::registration
