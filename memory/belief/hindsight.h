#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mapping/base/progress.h"
#include "memory/belief/belief.h"

namespace loci::memory::belief {

/// What an observation was of, as later scenes tell.
struct Supposition {
  int64_t object = 0;      ///< as Observation::known_object
  double probability = 1;  ///< among all that it might be of
};

/// Looks back over scenes for decisions that a later one contradicts. Which of several equal objects turned
/// up elsewhere cannot be told from the scene that shows one there; a later one shows which of them stands
/// where it stood all the time. Where that is the one that was chosen, each of the others, and a new object,
/// is supposed in its place; the scenes in between are reasoned about anew, and the supposition under which
/// they are most probable holds (the best joint hypothesis over these scenes).
///
/// `before`: the belief before the first of the scenes, which may have known objects. Gives what is known
/// then, besides, by the number of the observation. Empty where no decision was wrong.
std::map<int64_t, Supposition> hindsight(const BeliefState& before, const std::vector<Scene>& scenes,
                                         const BeliefOptions& options, Progress& progress);

}  // namespace loci::memory::belief
