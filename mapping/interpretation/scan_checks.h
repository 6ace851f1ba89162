#pragma once

#include <string>
#include <vector>

#include "mapping/interpretation/surface.h"

namespace loci::mapping {

/// Takes scans out that would spoil the map, with a note for each: scans without returns, and scans that
/// stand upside down (between floor and ceiling, furniture shows its tops, not its undersides). Error when
/// none is left, or when the scans as a whole are upside down.
void leave_out_bad_scans(const ScanSet& scans, Surface& surface, std::vector<std::string>& notes);

}  // namespace loci::mapping
