#pragma once

#include <string>

#include "mapping/sensor/colored_mesh.h"

namespace loci::mapping {

/// The mesh as binary glTF 2.0 (.glb), y up as the format asks, with its colours and without lighting.
std::string glb_bytes(const ColoredMesh& mesh);

}  // namespace loci::mapping
