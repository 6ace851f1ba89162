#pragma once

#include <vector>

#include "mapping/interpretation/fronts/fixtures.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Removes rows of upright bars that stand nearer to each other than fronts are wide, and what else is among
/// them: the ribs of a radiator, or the bars of a rack. Returns the bars of these rows.
std::vector<Fixture> remove_ribs(std::vector<FaceFixture>& fixtures);

/// Whether a front's fixture is a piece of a rib that was found in another face.
bool is_of_ribs(const Front& front, const std::vector<Fixture>& ribs);

}  // namespace loci::mapping
