#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/evaluate/system/scene_counts.h"
#include "mapping/simulation/scenario.h"
#include "perception/annotators/structure/known_map.h"

namespace loci::apps::system_evaluation {

/// An object of the pool from which scenes are set up.
struct HouseholdObject {
  std::string kind;  ///< "mug", "book"
  bool flat = false;
  mapping::ObjectSpec spec;
};

/// Crockery, food, packages, cutlery, books: nothing transparent, as in §8.2. Images for labels are looked
/// for in `labels`; a package whose image is not there is plain.
std::vector<HouseholdObject> household(const std::filesystem::path& labels);

/// Scenes as §8.2 has them: somebody clears one of the counters (links named counter…) and sets up so many
/// objects from the pool, no two touching, within what one look from before the counter shows. Counters take
/// turns. Error when the map has no counter.
mapping::Scenario household_scenario(const perception::KnownMap& map,
                                     const std::vector<HouseholdObject>& true_objects,
                                     const std::vector<SceneCount>& counts, const Random& random);

}  // namespace loci::apps::system_evaluation
