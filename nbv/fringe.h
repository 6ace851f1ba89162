#pragma once

#include <cstdint>
#include <vector>

#include "mapping/occupancy/occupancy.h"
#include "nbv/floor_region.h"

namespace loci::nbv {

/// Voxels with the fringe told apart: what views are counted on.
enum class ViewVoxel : uint8_t { unknown, free, occupied, fringe };

/// What each voxel is for a view. Fringe (§7.3.1.1) are free voxels with an unknown neighbour (six), windows
/// into the unknown. Above the highest surface seen, and below the floor, nothing is looked for: there, free
/// voxels stay free (a room without a ceiling would be endless).
struct ViewVoxels {
  std::vector<ViewVoxel> states;  ///< ordered like Voxels::states
  size_t fringe = 0;
};

/// Nothing is looked for outside `within` either.
ViewVoxels find_fringe(const mapping::Voxels& voxels, int threads, const FloorRegion& within = {});

}  // namespace loci::nbv
