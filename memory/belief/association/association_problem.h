#pragma once

#include <vector>

#include "memory/belief/evidence/pair_evidence.h"

namespace loci::memory::belief {

/// Combines evidence and priors into a data association problem (memory/identity).
LogOddsProblem association_problem(const BeliefState& state, const std::vector<Prediction>& predicted,
                                   const Scene& scene, const std::vector<PlaceView>& places,
                                   const PairEvidence& evidence, const BeliefOptions& options);

}  // namespace loci::memory::belief
