#pragma once

#include <vector>

#include "memory/belief/belief.h"

namespace loci::memory::belief {

/// A believed object as it is expected at the time of a scene.
struct Expectation {
  AxisBox box;               ///< map frame
  double variance = 0;       ///< of the centre, without the observation's own noise, m²
  double view_variance = 0;  ///< the part of it that is due to another view point
  double handled = 0;        ///< probability that somebody moved or took it since the last look
  double turned = 0;        ///< probability that it looks different though it stays: another side, or handled
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
/// The object's height counts: what is flat can hardly be told from the surface it lies on, and is often not
/// found. Where a detector without depth looked, only that it found nothing speaks.
EmptinessEvidence emptiness(const Expectation& expected, double empty_share, double seconds,
                            const BeliefOptions& options);

/// Whether scenes are too far apart in time to confirm each other.
bool is_snapshot(const BeliefState& state, const Scene& scene, const BeliefOptions& options);
double seconds_since_last_scene(const BeliefState& state, const Scene& scene);
/// BeliefState::attention_s at the time of a scene.
double attention_at(const BeliefState& state, const Scene& scene, const BeliefOptions& options);

/// Of what was seen of an object's place, the share that speaks against the object: looked through, or taken
/// by something else. `taken_by_other[k]`: how sure it is that observation k is something else there.
double empty_share(const OccupiedBy& seen, const std::vector<double>& taken_by_other);

/// Whether an observation is a piece of what is believed to be in a box: it lies inside and is much smaller.
/// In a video that is how things look that are cut by chairs, glare or missing depth.
bool is_piece(const Expectation& believed, const AxisBox& seen);

/// Share of an observation that lies where an object is believed to be, its uncertainty included.
double covered_share(const Expectation& believed, const AxisBox& seen);

PairEvidence pair_evidence(const BeliefState& state, const std::vector<Expectation>& expected,
                           const Scene& scene, const BeliefOptions& options);

/// Folds evidence and priors into a problem of memory/identity.
LogOddsProblem identity_problem(const BeliefState& state, const std::vector<Expectation>& expected,
                                const Scene& scene, const PairEvidence& evidence,
                                const BeliefOptions& options);

}  // namespace loci::memory::belief
