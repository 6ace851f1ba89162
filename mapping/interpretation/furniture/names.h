#pragma once

#include "mapping/interpretation/furniture/map_links.h"

namespace loci::mapping {

// Names depend on positions in the room, so that a second scan of the same kitchen yields the same names.

/// Names of walls by the side of the room, clockwise: "wall_north" is on the +y side; further walls of a side
/// have _2, _3.
std::vector<std::string> wall_names(const RecognisedRoom& room);

/// Names of supports: class and number, clockwise along the walls from the north-west corner.
std::vector<std::string> support_names(const RecognisedRoom& room);

/// The order in which fronts are numbered: clockwise along the sides of the room, column by column from the
/// top.
std::vector<size_t> front_order(const std::vector<Front>& fronts, double room_yaw);

/// The result of transfer_names().
struct NameTransfer {
  size_t kept = 0;                    ///< links that were in the older map and have their old names
  std::vector<std::string> added;     ///< names that are not in the older map
  std::vector<std::string> vanished;  ///< names of the older map that have no link now

  std::string summary() const;
};

/// Gives links (and their joints, LINK_joint) the names that they have in an older map of the same place in
/// the same frame, with the aliases and appliances that people set: walls by plane, supports, floor and
/// ceiling by height and outline, fronts with their parts by position. New links get numbers that the older
/// map does not use.
NameTransfer transfer_names(World& world, SemanticMap& semantics, const SemanticMap& older);

}  // namespace loci::mapping
