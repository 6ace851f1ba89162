#pragma once

#include <string>
#include <vector>

#include "mapping/interpretation/map_links.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Joint and class of each front by its shape (joint_prior), names by class and number, and the links. Fronts
/// are numbered clockwise along the sides of the room, column by column from the top, so that the same
/// kitchen scanned again gets the same names.
void add_fronts(const RecognisedRoom& room, std::vector<Front> fronts, InterpretedMap& map);

/// Puts fronts that have learned more (joint, class, rectangle) in the place of the map's, with names made
/// anew.
void replace_fronts(std::vector<Front> fronts, InterpretedMap& map);

}  // namespace loci::mapping
