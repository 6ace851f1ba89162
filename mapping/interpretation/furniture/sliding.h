#pragma once

#include <vector>

#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Whether a front's joint moves it along its own plane, as a sliding door.
bool slides_sideways(const Front& front);

/// Gives panels that pass each other a sliding joint: neighbours of one height in planes some centimetres
/// apart. Other furniture may stand out from its neighbours, too: the probability of the joint says so.
void pair_sliding_panels(std::vector<Front>& fronts);

}  // namespace loci::mapping
