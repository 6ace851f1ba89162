#pragma once

#include "mapping/exchange/map_structure.h"
#include "mapping/world/world_triangles.h"

namespace loci::mapping {

/// Fronts, handles and knobs as a sidecar and the joints of its world tell.
void add_sidecar_furniture(const World& world, const SemanticMap& sidecar, const std::string& file,
                           MapStructure& structure);

/// `handles` and `joints` of a truth.json; what is not `visible_when_closed` is not main. Regions from
/// REGION_bounds.
void add_truth_furniture(const Json& truth, const std::string& file, MapStructure& structure);

/// `fronts` with their `handle`s as a person measured them in a real room, each with its tolerance. Where no
/// front is listed nothing is known.
void add_measured_fronts(const Json& truth, const std::string& file, MapStructure& structure);

/// Best effort for a URDF that says no more than shapes and joints: links fixed to something and called
/// handle or knob, and for each link that moves the largest upright face of what moves with it, towards its
/// handle or away from what it is mounted on. What something stands before is not main.
void add_geometry_furniture(const World& world, const std::vector<WorldTriangle>& triangles,
                            MapStructure& structure);

}  // namespace loci::mapping
