#pragma once

#include <filesystem>

#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// A map as it is stored: the URDF, and the sidecar beside it.
void write_map(const World& world, const SemanticMap& semantics, const std::filesystem::path& urdf);

}  // namespace loci::mapping
