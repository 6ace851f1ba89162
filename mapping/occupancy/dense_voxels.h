#pragma once

#include <octomap/OcTree.h>

#include "mapping/occupancy/occupancy.h"

namespace loci::mapping::occupancy {

/// The leaves of a tree as an array that is as large as what they cover.
Voxels dense_voxels(const octomap::OcTree& tree, int threads);

}  // namespace loci::mapping::occupancy
