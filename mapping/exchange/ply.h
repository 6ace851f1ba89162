#pragma once

#include <string>
#include <vector>

#include "mapping/exchange/world_triangles.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

/// Triangles as binary PLY (little endian): vertices with colour, three to a face so that faces keep theirs.
std::string ply_text(const std::vector<WorldTriangle>& triangles);

/// The returns of all scans as binary PLY: x y z in the map frame, intensity, colour.
std::string ply_text(const ScanSet& scans);

}  // namespace loci::mapping
