#pragma once

#include <cstdint>
#include <vector>

#include "mapping/occupancy/floor_grid.h"
#include "mapping/occupancy/occupancy.h"

namespace loci::nbv {

/// Occupancy with the frontier distinguished: what the gain and overlap of views are counted on.
enum class ViewVoxel : uint8_t { unknown, free, occupied, frontier };

/// The frontier (the dissertation calls it fringe, §7.3.1.1) consists of free voxels with an unknown voxel
/// among their six neighbours. Above the highest surface seen and below the floor there is no frontier: a
/// room without a ceiling would be endless.
struct ViewVoxels {
  std::vector<ViewVoxel> states;  ///< ordered like Voxels::states
  size_t frontier = 0;
};

/// Marks the frontier inside `within`.
ViewVoxels find_frontier(const mapping::Voxels& voxels, int threads, const mapping::FloorRegion& within = {});

}  // namespace loci::nbv
