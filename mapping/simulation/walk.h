#pragma once

#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/pose.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Camera poses (optical frame, map frame) of a person who walks through a closed world and turns round every
/// 0.8 m, with the camera held low and high: what furniture shows to the floor is seen from one metre or
/// two, from several sides. Error when nowhere inside the world is room to stand.
std::vector<Isometry3d> walk_through(const World& world, const MeshSearch& search, Warnings& warnings);

}  // namespace loci::mapping
