#pragma once

#include <vector>

#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Decides on which side doors without fixture have their hinge, and says by what
/// (JointEstimate::hinge_from): the two doors of a cupboard, equal and side by side, open away from each
/// other ("pair"). Of other doors nothing shows the side: it stays as it is ("assumed").
void pair_wings(std::vector<Front>& fronts);

}  // namespace loci::mapping
