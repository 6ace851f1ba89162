#pragma once

#include <string>
#include <vector>

#include "memory/identity/problem.h"
#include "memory/identity/states.h"

namespace loci::memory {

/// One complete story: which old object is which new observation. Who is not in it is unmatched.
struct Matching {
  std::vector<std::pair<size_t, size_t>> pairs;  ///< (old, new), ascending
  double log_weight = 0;
  double log_probability = 0;
};

/// The exact posterior of an identity problem. Rows sum to one over stay, move, newview of all observations
/// and disappear, missed, hidden; columns over all objects and appear, clutter.
struct IdentitySolution {
  PairTable stay, move, newview;
  PairTable none;                                 ///< probability that the two are not the same
  std::vector<double> appear, clutter;            ///< per observation
  std::vector<double> disappear, missed, hidden;  ///< per object
  std::vector<double> out_of_view_posterior;      ///< per object
  double log_z = 0;                               ///< log of the sum over all matchings, in odds form
  double log_evidence = 0;     ///< log probability that the formulas hold (without priors and clutter)
  Matching map;                ///< the most probable matching
  bool map_unique = true;      ///< no other matching is as probable
  std::vector<Matching> best;  ///< ranked; those with a pair that gating dropped are left out
  /// No probability above is off by more than this, and log_z by at most -log(1 - bound).
  double gate_bound = 0;

  size_t old_count() const { return disappear.size(); }
  size_t new_count() const { return appear.size(); }
};

/// The most probable partner (unset = none: appeared, or disappeared and the like) and, judged on its own,
/// the most probable explanation. The two can disagree when everything is below one half; a consumer that
/// needs one consistent story takes the MAP matching.
struct IdentityDecision {
  std::optional<size_t> partner;
  double partner_probability = 0;
  Explanation explanation = Explanation::appear;
  double explanation_probability = 0;
};
IdentityDecision decide_observation(const IdentitySolution& solution, size_t observation);
IdentityDecision decide_object(const IdentitySolution& solution, size_t object);

/// Exact marginals, partition function and ranked matchings. Problems in whose connected parts more than 20
/// rows stay open at a time are split further by enlarging the gate, which `gate_bound` tells.
IdentitySolution solve(const IdentityWeights& weights, const IdentityOptions& options = {});
IdentitySolution solve(const IdentityProblem& problem, const IdentityOptions& options = {});
IdentitySolution solve(const LogOddsProblem& problem, const IdentityOptions& options = {});

}  // namespace loci::memory
