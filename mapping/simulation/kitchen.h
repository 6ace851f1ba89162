#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// How the furniture of a drawn kitchen is laid out, in the order of its seeds: seed 0 draws the first.
inline constexpr std::array<std::string_view, 9> kKitchenLayouts = {
    "line",       // one wall of base, tall and upper cabinets; a table
    "galley",     // two opposite walls
    "corner",     // two walls that meet; a table
    "u",          // three walls; upper cabinets on one
    "island",     // one wall and an island with cabinets towards it; stools
    "peninsula",  // two walls, and a row that reaches into the room
    "diner",      // a corner kitchen and a dining room with a sideboard behind a passage
    "alcove",     // an L-shaped room with a chimney; wall shelves instead of upper cabinets
    "workshop"};  // a wall of tall cupboards, a low sideboard, a workbench with drawers

/// A kitchen that nobody measured, with the truth about it.
struct DrawnKitchen {
  World world;            ///< boxes, cylinders and spheres; root "map", metres, floor at 0
  SemanticMap semantics;  ///< floor, walls with openings, supports, fronts with joints, handles and knobs
};

/// Draws a kitchen of a layout: sizes, units and their order, kinds of handles, colours, clutter, and its
/// pose in the map. Same seed, same kitchen. Error for an unknown layout.
DrawnKitchen draw_kitchen(std::string_view layout, uint64_t seed);

}  // namespace loci::mapping
