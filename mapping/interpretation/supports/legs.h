#pragma once

#include <vector>

#include "mapping/interpretation/supports/supports.h"
#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {

/// Footprints of the legs or the pedestal of a table in the table's axes, as far as they were seen: upright
/// posts below the top that reach up to it. What chairs hide is not there.
std::vector<Extent> find_legs(const Surface& surface, double floor_height, const Support& table);

}  // namespace loci::mapping
