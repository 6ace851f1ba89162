#pragma once

// Of this room alone: how the belief is carried over one scene.

#include <cmath>
#include <optional>
#include <vector>

#include "memory/belief/belief.h"
#include "memory/belief/evidence.h"

namespace loci::memory::belief {

inline double log_odds(double probability) {
  return std::log(probability / (1 - probability));
}

/// A leftover that is less probable is not kept.
inline constexpr double kMinLeftover = 2e-4;

/// Carries the belief over one scene; its members are what the parts of that share.
class Step {
 public:
  Step(BeliefState& state, const Scene& scene, const BeliefOptions& options);
  BeliefUpdate run();

 private:
  // Who is who (step_pairs.cpp).
  void pair_up();
  /// In a video, what is seen where a known object must be is that object rather than a new one: drift of the
  /// pose and cut views would otherwise make doubles.
  void prefer_known(size_t k);
  Explanation explanation_of_pair(size_t o, size_t k) const;
  void report_distributions();
  /// What each track may be after this scene instead of what it is taken for.
  std::vector<std::vector<Alternative>> mixed_alternatives() const;
  double probability(size_t o, size_t k) const;

  // What is seen (step_seen.cpp).
  void see(size_t o, size_t k);
  void mark_seen(ProtoObject& object, const Observation& observation);
  /// Something that is none of the believed objects.
  void meet(size_t k);
  void confirm(ProtoObject& object, std::optional<size_t> k);
  /// Before a long pause nothing more can be learned: what was seen, if only once and cut off, and was not
  /// missed is believed.
  void confirm_unrefuted();

  // What is not seen (step_unseen.cpp).
  void miss(size_t o);
  /// Likelihoods of what was measured where an object was expected: times what was expected if it is there
  /// and if it left, and where there is nothing.
  struct Whether {
    double there = 0, away = 0, nothing = 0;
    double probability() const;
  };
  Whether whether_there(size_t o) const;
  /// empty_share() now that it is decided what the others are (a cluster that swallowed both does not count).
  double empty_share_in_hindsight(size_t o) const;
  void note_hidden(ProtoObject& object, const Expectation& e);
  void forget_clutter();
  /// What is gone can be recognised when it comes back, but not everything that ever was is compared with
  /// all that is seen: those missing for longest are let go.
  void retire();

  // What was taken for moved and may have stayed (step_leftovers.cpp).
  /// Something stands where an object stood that is taken for having moved, and looks like it: it never
  /// moved, and what was followed since is something else.
  void reclaim_leftovers();
  void reclaim(size_t o, size_t k);
  /// Takes note that what is taken for moved may still be where it was. To be called before it is put there.
  void leave_behind(size_t o, size_t k);

  // What scenes teach (step_learning.cpp).
  /// What the home's habits are: from looks that lie apart only, since video frames confirm each other.
  void learn_from_sighting(size_t o, size_t k);
  /// What surely stayed and is found whole both times shows how well poses and visible parts agree. Where it
  /// moved a little after all it must not count in full.
  void learn_view_noise(size_t o, size_t k);
  /// How alike looks at one thing are, and looks at different ones.
  void learn_likeness();
  void learn_from_absence(ProtoObject& object);
  /// Whether what was new is found again shows how often what is new is a false cluster.
  void learn_doubt(ProtoObject& object, double if_false, double if_real);
  void learn_arrivals();

  void finish_outcomes();

  BeliefState& state_;
  const Scene& scene_;
  const BeliefOptions& options_;
  const bool snapshot_;
  const double seconds_;
  const bool apart_;  ///< long enough after the scene before to teach about habits
  const double attention_;
  std::vector<Expectation> expected_;
  IdentityWeights weights_;
  IdentitySolution solution_;
  std::vector<std::optional<size_t>> partner_of_object_, partner_of_observation_;
  std::vector<ProtoObject> leftovers_;  ///< of this scene
  BeliefUpdate update_;
};

}  // namespace loci::memory::belief
