#pragma once

#include "memory/belief/belief.h"

namespace loci::memory::belief {

/// How one believed object stood as an explanation of an observation. Compact: this is kept with the scene.
struct Candidate {
  int64_t key = 0, object = 0;            ///< proto object; memory's number, 0 = tentative
  float stay = 0, move = 0, newview = 0;  ///< posterior probabilities
  float similar = 0, proximity = 0;       ///< log-likelihood ratios, same object against unrelated
  float stay_prior = 0, move_prior = 0, newview_prior = 0;  ///< log weights before the evidence
  std::vector<float> distances;                             ///< per Decisions::kinds; NaN = not comparable
  std::vector<float> log_ratios;  ///< what these told; apart from the rest (Decisions::log_ratios)

  double probability() const { return double(stay) + move + newview; }

  template <class Archive>
  void archive(Archive& fields) {
    fields(key, object, stay, move, newview, similar, proximity, stay_prior, move_prior, newview_prior,
           distances);
  }
};

/// What an observation was taken for and what else was considered.
struct ObservationDecision {
  uint8_t explanation = 0;      ///< Explanation
  int64_t key = 0, object = 0;  ///< 0 = clutter or tentative
  float probability = 0, appear = 0, clutter = 0;
  float appear_prior = 0, clutter_prior = 0;  ///< log weights
  std::vector<Candidate> candidates;          ///< most probable first

  Explanation chosen() const { return static_cast<Explanation>(explanation); }

  template <class Archive>
  void archive(Archive& fields) {
    fields(explanation, key, object, probability, appear, clutter, appear_prior, clutter_prior, candidates);
  }
};

/// What was concluded about an object that was not seen, and what its place showed (shares of its box).
struct ObjectDecision {
  uint8_t explanation = 0;  ///< Explanation
  int64_t key = 0, object = 0;
  float out_of_view = 0, hidden = 0, unmeasured = 0, occupied = 0, seen_through = 0, searched = 0;
  float disappear = 0, missed = 0, out_of_sight = 0;  ///< probabilities
  float here = 0;                                     ///< afterwards, of being where it was seen last

  Explanation chosen() const { return static_cast<Explanation>(explanation); }

  template <class Archive>
  void archive(Archive& fields) {
    fields(explanation, key, object, out_of_view, hidden, unmeasured, occupied, seen_through, searched,
           disappear, missed, out_of_sight, here);
  }
};

/// Every decision of one scene with what it rests on.
struct Decisions {
  std::vector<std::string> kinds;                 ///< of annotations that were compared
  std::vector<ObservationDecision> observations;  ///< in the order of the scene
  std::vector<ObjectDecision> unseen;  ///< objects that were not seen though their place was in view in part
  float gate_bound = 0;                ///< largest error of a probability

  /// Those of all candidates, in order, as they are kept beside the other fields.
  std::vector<float> log_ratios() const;
  /// Puts them back. Without any: what distances tell before anything was learned, as the first versions had.
  void set_log_ratios(const std::vector<float>& all);

  template <class Archive>
  void archive(Archive& fields) {
    fields(kinds, observations, unseen, gate_bound);
  }
};

Decisions decisions_of(const BeliefUpdate& update);

/// Why a candidate was not taken, in words: the rule that forbade it or the evidence that spoke against it.
std::string objection(const Decisions& decisions, size_t observation, const Candidate& candidate);

}  // namespace loci::memory::belief
