#pragma once

#include <filesystem>

namespace loci::gui::test {

/// A memory of a large map, written through the store: `objects` boxes in rows on the floor of the room, some
/// of which move in every scene, and `scenes` looks with image and depth from around. The map is the URDF
/// of this name below `package`, whose meshes are found from the memory's folder.
void write_large_memory(const std::filesystem::path& path, const std::filesystem::path& package,
                        const std::string& urdf, int objects, int scenes);

}  // namespace loci::gui::test
