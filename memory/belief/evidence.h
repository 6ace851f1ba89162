#pragma once

#include <vector>

#include "memory/belief/belief.h"

namespace loci::belief {

/// A believed object as it is expected at the time of a scene.
struct Expectation {
  AxisBox box;              ///< map frame
  double variance = 0;      ///< of the centre, without the observation's own noise, m²
  double handled = 0;       ///< probability that somebody moved or took it since the last look
  double here = 1;          ///< probability that it is still there
  OccupiedBy seen;          ///< what looking there showed
  double undetectable = 0;  ///< too little of it in view
};

std::vector<Expectation> expect(const BeliefState& state, const Scene& scene, const BeliefOptions& options);

/// Log likelihoods of what was measured at a place, for an object that is there and for one that is not.
/// Looks that follow each other quickly repeat each other's errors and count for less.
struct EmptinessEvidence {
  double if_there = 0;
  double if_gone = 0;
};
EmptinessEvidence emptiness(double empty_share, double seconds, const BeliefOptions& options);

/// Whether scenes are too far apart in time to confirm each other.
bool is_snapshot(const BeliefState& state, const Scene& scene, const BeliefOptions& options);
double seconds_since_last_scene(const BeliefState& state, const Scene& scene);

PairEvidence pair_evidence(const BeliefState& state, const std::vector<Expectation>& expected,
                           const Scene& scene, const BeliefOptions& options);

/// Folds evidence and priors into a problem of memory/identity.
LogOddsProblem identity_problem(const BeliefState& state, const std::vector<Expectation>& expected,
                                const Scene& scene, const PairEvidence& evidence,
                                const BeliefOptions& options);

}  // namespace loci::belief
