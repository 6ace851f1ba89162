#pragma once

#include <vector>

#include "mapping/interpretation/supports/supports.h"
#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {

/// The legs or the pedestal of a table, as far as they were seen: upright posts below the top that reach up
/// to it, or stand below its middle, where the top hides their upper part. What chairs hide is not there.
std::vector<Leg> find_legs(const Surface& surface, double floor_height, const Support& table);

}  // namespace loci::mapping
