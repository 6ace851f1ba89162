#pragma once

#include <vector>

#include "mapping/interpretation/surfaces/surface.h"
#include "mapping/interpretation/surfaces/vertical_planes.h"

namespace loci::mapping {

/// A rectangular hole in a wall, in the wall's plane.
struct WallOpening {
  double along_min = 0, along_max = 0;  ///< as of VerticalPlane, metres
  double bottom = 0, top = 0;           ///< z
  bool doorway = false;                 ///< it begins at the floor; else a window
  double seen = 0;                      ///< share of it that rays passed through
};

/// Doorways and windows of each wall, in order along it: where rays passed through its plane in a rectangle
/// whose sides and top (and sill) they ended on. What furniture hides does not count, nor does the
/// end of a wall. Same result on any number of threads.
std::vector<std::vector<WallOpening>> find_openings(const Surface& surface,
                                                    const std::vector<VerticalPlane>& walls,
                                                    double floor_height, int threads);

}  // namespace loci::mapping
