#pragma once

#include <string>
#include <vector>

#include "mapping/interpretation/fronts/furniture_face.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surfaces/surface.h"
#include "mapping/interpretation/surfaces/walls.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

struct FrontSearch {
  std::vector<Front> fronts;
  std::vector<FurnitureFace> faces;  ///< all that were searched
  std::vector<Fixture> ribs;         ///< bars that stand in rows, too near to each other for handles
  std::vector<std::string> notes;    ///< what was rejected and why
};

/// Furniture fronts with their handles and knobs (§7.4): cuts vertical furniture faces along seams, edges,
/// and changes of colour or intensity. Each fixture yields one front; a front without fixture needs resolved
/// seams.
FrontSearch find_fronts(const Surface& surface, double floor_height, const WallSearch& vertical,
                        const InterpretationOptions& options, Progress& progress);

/// Of fronts that meet at an outer corner of furniture, takes out the less certain one: it is the side of
/// what the other one opens.
void drop_side_panels(std::vector<Front>& fronts);

}  // namespace loci::mapping
