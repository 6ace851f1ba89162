#pragma once

#include <vector>

#include "mapping/registration/prepared_scan.h"

namespace loci::registration {

/// How far the true pose may be from the guess, at most.
struct SearchWindow {
  double position = 0;  ///< metres
  double angle = 0;     ///< radians
};

/// The most promising poses within a window around a guess, best first, the guess itself among them: turns
/// and shifts on a grid are scored by how many coarse surfels of the source lie on ones of the target with
/// agreeing normals (a correlative search, Olson 2009). x, y, yaw when planar, otherwise all six.
std::vector<Isometry3d> promising_starts(const PreparedScan& target, const PreparedScan& source,
                                         const Isometry3d& target_from_source, const SearchWindow& window,
                                         bool planar, size_t count);

}  // namespace loci::registration
