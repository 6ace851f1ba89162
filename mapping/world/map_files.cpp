#include "mapping/world/map_files.h"

#include "mapping/world/urdf.h"

namespace loci::mapping {

void write_map(const World& world, const SemanticMap& semantics, const std::filesystem::path& urdf) {
  write_urdf(world, urdf);
  write_semantic_map(semantics, sidecar_path(urdf));
}

}  // namespace loci::mapping
