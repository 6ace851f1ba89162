#pragma once

#include <cstdint>
#include <vector>

#include "mapping/occupancy/floor_grid.h"

namespace loci::nbv {

/// A value per cell of the floor and orientation: layer l looks along yaw 2π · l / layers.
struct CostmapStack {
  std::vector<std::vector<float>> layers;

  double yaw(size_t layer) const;
};

/// The visibility kernel K(φ, d_min, d_max) of §7.3.1.2 for one orientation: the cells, relative to a
/// voxel's, from which a sensor with that orientation sees the voxel. Stored as runs of cells per row.
class VisibilityKernel {
 public:
  /// `opening` φ and `yaw` in radians, distances and cell in metres.
  VisibilityKernel(double opening, double min_distance, double max_distance, double yaw, double cell);

  struct Run {
    int y, x_begin, x_end;  ///< cells [x_begin, x_end) of row y, relative
  };
  const std::vector<Run>& runs() const { return runs_; }

 private:
  std::vector<Run> runs_;
};

/// Adds the kernel of each orientation as a stencil at every cell, `votes` times: how many voxels could be
/// seen from each pose if nothing was in the way. `votes` has a count per cell of the floor grid.
CostmapStack vote(const mapping::FloorGrid& floor, const std::vector<int>& votes,
                  const std::vector<VisibilityKernel>& kernels, int threads);

}  // namespace loci::nbv
