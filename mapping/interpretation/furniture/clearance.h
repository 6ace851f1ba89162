#pragma once

#include <string>
#include <vector>

#include "mapping/world/furniture.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Makes room where fronts, which are in the map already, contradict each other or what they stand in: of two
/// that penetrate each other in the closed state, the less certain one loses the collision shapes that the
/// other one needs as either of them opens. A front that was moved is surer than one that was not, else the
/// more confident one is. Inferred bodies give way to fronts, fronts to all else. Visual shapes stay as they
/// were seen.
void clear_closed_state(const std::vector<Front>& fronts, World& world, const SemanticMap& semantics);

/// The same for what stops a joint before `min_upper`, which is less than any furniture opens.
void clear_beginning(const std::string& joint, double min_upper, const std::vector<Front>& fronts,
                     World& world, const SemanticMap& semantics);

}  // namespace loci::mapping
