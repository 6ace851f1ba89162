#pragma once

#include <string>

#include "mapping/base/error.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// A world as MJCF (MuJoCo) with the same names: a body per link, a slide or hinge per joint that moves, and
/// a motor of the joint's name whose control is a force (N) or torque (N m) up to the joint's effort. Visual
/// shapes are in group 2 and collide with nothing, collision shapes in group 3. Meshes are part of the text;
/// flat ones become boxes. A link 'world' that is not the root is called 'world_link'. Floating and planar
/// joints are warned about and fixed.
std::string mjcf_text(const World& world, const MeshSearch& search, Warnings& warnings);

}  // namespace loci::mapping
