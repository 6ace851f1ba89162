#pragma once

#include <string>
#include <vector>

#include "mapping/world/furniture.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Writes the bodies of furniture behind fronts, which are in the map already, as links "cabinet_N" of class
/// cabinet, or "fridge_N" with the appliance "fridge" behind the doors of a refrigerator, fixed to `parent`:
/// two sides, back, bottom and top, without what would penetrate the map. A column of fronts, and doors that
/// open away from each other, have one body. It ends at the wall behind, else below the back edge of the
/// support above; otherwise its depth is assumed (evidence "depth"). The link's origin is at the centre of
/// the bottom inside, x outward; the sidecar has `height` and `outline` of that, the `top` of the space over
/// it, and the names of its `fronts`.
void add_cabinets(const std::vector<Front>& fronts, const std::string& parent, World& world,
                  SemanticMap& semantics);

/// Whether a link of the sidecar is a body that add_cabinets() wrote: inferred, not seen.
bool is_inferred_cabinet(const SemanticLink& link);

/// Removes what add_cabinets() wrote.
void remove_cabinets(World& world, SemanticMap& semantics);

}  // namespace loci::mapping
