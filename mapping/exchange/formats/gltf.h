#pragma once

#include <string>

#include "mapping/sensor/colored_mesh.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// The mesh as binary glTF 2.0 (.glb), y up as the format asks, with its colours and without lighting.
std::string glb_bytes(const ColoredMesh& mesh);

/// A world as binary glTF 2.0, y up: below a node per joint (pose of the joint; type, axis and limits as
/// extras) the node of its link, which moves in it, with the link's visuals as a mesh. Nodes have the names
/// of the joints and links. Joints that move have an animation from 0 to their upper limit. Textures are part
/// of the file, at most 2048 pixels wide and high.
std::string glb_bytes(const World& world, const MeshSearch& search, Warnings& warnings);

}  // namespace loci::mapping
