#pragma once

#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surface.h"
#include "mapping/interpretation/walls.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

struct FrontSearch {
  std::vector<Front> fronts;
  std::vector<std::string> notes;  ///< what was left out and why
};

/// Furniture fronts with their handles and knobs (§7.4): vertical furniture faces are cut along seams, edges,
/// and changes of colour or intensity; each fixture grows one front; a front without fixture is reported only
/// where its seams were resolved.
FrontSearch find_fronts(const Surface& surface, double floor_height, const WallSearch& vertical,
                        const InterpretationOptions& options, Progress& progress);

}  // namespace loci::mapping
