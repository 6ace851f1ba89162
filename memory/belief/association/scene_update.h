#pragma once

#include <optional>
#include <vector>

#include "mapping/base/math/log_odds.h"
#include "memory/belief/belief.h"

namespace loci::memory::belief {

/// Updates the belief with one scene. run() is the algorithm; stages share the members.
class SceneUpdate {
 public:
  SceneUpdate(BeliefState& state, const Scene& scene, const BeliefOptions& options);
  BeliefUpdate run();

 private:
  // Data association (scene_update.cpp).
  void solve_association();
  /// Takes the MAP hypothesis over, as one consistent explanation of the scene.
  void choose_partners();
  /// In a video, an observation at the spot of a known object is that object rather than a new one: drift of
  /// the pose and cut views would otherwise create doubles.
  void prefer_known_object(size_t k);
  void pair(size_t o, size_t k);
  Explanation pair_explanation(size_t o, size_t k) const;
  void report_observations();
  void report_objects();
  /// Alternative identities of each track after this scene.
  std::vector<std::vector<Alternative>> propagated_alternatives() const;
  double pair_probability(size_t o, size_t k) const;
  /// The part of it by which the observation is a cluster of several.
  double in_cluster(size_t o, size_t k) const;
  double log_proximity(size_t o, size_t k) const;
  /// Evidence of appearance but for the size.
  double color_log_ratio(size_t o, size_t k) const;
  double stay_probability(size_t o, size_t k) const;
  /// Fills in object numbers and posteriors once all objects are updated.
  void finish_outcomes();

  // One object that is observed, or believed, as several, and several that are observed as one (pieces.cpp).
  void join_pieces();
  /// A whole observation that lies where several objects stand side by side, and is as large as all of them
  /// together, may be a cluster of them all: they are there, though at most one of them is found.
  void find_merged(size_t k);
  /// The objects that an observation may be a cluster of, the largest first; empty where fewer than two are.
  std::vector<size_t> possible_parts(size_t k) const;
  /// Probability that an observation is a cluster of these objects, against the MAP hypothesis.
  double merged_probability(size_t k, const std::vector<size_t>& parts) const;
  /// Leaves the rest of the posterior to the other hypotheses. The part that the cluster is taken for is
  /// found in it, the others are missed; none of them looks like it, so nothing is learned from the pair.
  void share_with_merged(size_t k, const std::vector<size_t>& parts, double merged);
  /// Log weight of an object not being found.
  double log_absent(size_t o) const;
  /// What hides the middle of an object cuts it in two. Of two pieces the larger one is the object, the other
  /// is clutter.
  void find_further_piece(size_t k);
  /// How many observations like k are expected of object o beside the one that it is found as.
  double expected_pieces(size_t o, size_t k) const;
  /// Two objects cannot be at one place: what is believed where a whole view shows another one is the same
  /// object, of which pieces had been seen. The one that was observed more often is kept.
  void find_doubles(size_t k);
  void remove_double(size_t o);
  /// Forgets the doubles of the scene before, which reported them as gone: they do not come back.
  void drop_doubles();
  /// Counts, for what lies in drawers and on furniture, that these were opened, shut or moved unseen.
  void note_uses();

  // Alternative hypotheses: what is believed to have moved may have stayed. Two similar objects must not
  // become one that goes to and fro, so the second hypothesis is kept until the spot is observed again
  // (object_updates.cpp).
  /// An observation at the old spot of a moved object confirms the alternative hypothesis: that object never
  /// moved, and what was tracked since is another one.
  void reinstate_alternatives();
  void reinstate(size_t o, size_t k);
  /// Keeps the hypothesis that the object did not move. Called before its box is reset.
  void keep_alternative(size_t o, size_t k);

  // Observed objects (object_updates.cpp).
  void update_observed(size_t o, size_t k);
  void update_box_and_views(size_t o, size_t k, const Observation& observation, Explanation explanation,
                            bool piece);
  void mark_observed(ProtoObject& object, const Observation& observation);
  void create_object(size_t k);
  void confirm(ProtoObject& object, std::optional<size_t> k);
  /// Before a long pause no more evidence can come: confirms tentative objects that were never missed.
  void confirm_unrefuted();

  // Unobserved objects (object_updates.cpp).
  void update_unobserved(size_t o);
  /// Joint probabilities of what was measured at an object's spot with the object being there or away, and
  /// the likelihood of an empty spot.
  struct PresenceEvidence {
    double there = 0, away = 0, empty = 0;
    double probability() const;
  };
  PresenceEvidence presence_evidence(size_t o) const;
  /// empty_share() given the partners of all observations (merged clusters do not count).
  double posterior_empty_share(size_t o) const;
  /// Probability that an object in full view is found. False objects of a video must not lower it for the
  /// others before they are confirmed.
  double detection_rate() const;
  /// Probability that a false cluster is found again: in a video mostly by the same mistake.
  double repeat_clutter() const;
  void set_gone(size_t o);
  void note_hidden(ProtoObject& object, const Prediction& predicted);
  void delete_clutter();
  /// Bounds the number of gone objects that observations are compared with: the longest gone are dropped.
  void prune_gone();

  // Learning, from independent scenes only: video frames repeat each other (learning.cpp).
  /// An object that is found again where it was not detected had been missed.
  void learn_detection(ProtoObject& object, Explanation explanation);
  void learn_interactions();
  /// Whether an object was handled, and what became of it: what the association found against what was
  /// expected of the observed places.
  void learn_handling(size_t o);
  /// Objects that stayed and are whole in both views show how accurate poses are.
  void learn_view_noise();
  /// Distances between views of one object and of different ones.
  void learn_similarity();
  /// Each later view of a new object's spot shows whether it was clutter. `if_clutter`, `if_object`:
  /// likelihoods of what it showed.
  void weigh_clutter(ProtoObject& object, double if_clutter, double if_object) const;
  /// A new object was found again, or is gone: how often new objects are clutter.
  void learn_clutter(ProtoObject& object);
  void learn_arrivals();

  BeliefState& state_;
  const Scene& scene_;
  const BeliefOptions& options_;
  const SceneTiming timing_;
  std::vector<PlaceView> places_;  ///< that the scene shows
  std::vector<Prediction> predicted_;
  std::vector<Surface> surfaces_;  ///< of the observations
  IdentityWeights weights_;
  IdentitySolution solution_;
  std::vector<std::optional<size_t>> partner_of_object_, partner_of_observation_;
  std::vector<double> piece_probability_;  ///< per observation, against being a new object
  std::vector<bool> is_double_;            ///< per object
  std::vector<double> merged_;             ///< per object: probability that a cluster of several shows it
  std::vector<ProtoObject> alternatives_;  ///< hypotheses of this scene
  BeliefUpdate update_;
};

}  // namespace loci::memory::belief
