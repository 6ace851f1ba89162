#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/sensor/colored_mesh.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/world_triangles.h"

namespace loci::mapping {

/// Triangles as binary PLY (little endian): vertices with colour, three to a face so that faces keep theirs.
std::string ply_text(const std::vector<WorldTriangle>& triangles);

std::string ply_text(const ColoredMesh& mesh);
/// What ply_text made of a mesh. Error for any other file.
ColoredMesh read_ply_mesh(const std::filesystem::path& path);

/// The returns of all scans as binary PLY: x y z in the map frame, intensity, colour.
std::string ply_text(const ScanSet& scans);

}  // namespace loci::mapping
