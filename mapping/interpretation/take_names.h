#pragma once

#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// What became of the names of an older map.
struct TakenNames {
  size_t kept = 0;                    ///< things that were there before and have their old name again
  std::vector<std::string> added;     ///< new things; their names were not in the older map
  std::vector<std::string> vanished;  ///< names of the older map that nothing has now

  std::string summary() const;
};

/// Gives links (and their joints, LINK_joint) the names that they have in an older map of the same place in
/// the same frame, with the aliases and appliances that people gave: walls by plane, supports, floor and
/// ceiling by height and outline, fronts with all that belongs to them by where they are. What is new gets a
/// number that the older map has not used.
TakenNames take_names(World& world, SemanticMap& semantics, const SemanticMap& older);

}  // namespace loci::mapping
