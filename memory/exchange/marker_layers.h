#pragma once

#include <vector>

#include "mapping/recording/markers.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"
#include "memory/store/store.h"

namespace loci::memory {

/// A map as markers: what stands still on the topic /map, parts that move on /map/moving with the joints of
/// each frame. Meshes that cannot be read are warned about and left out.
std::vector<mapping::MarkerLayer> map_layers(const mapping::World& map, const mapping::MeshSearch& search,
                                             Warnings& warnings);

/// What a memory believes at the time of each frame: a box with a name per object that has not gone, the
/// paler the less probable it is that it is there. `store` outlives the layer.
mapping::MarkerLayer object_layer(const Store& store);

}  // namespace loci::memory
