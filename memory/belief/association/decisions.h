#pragma once

#include "memory/belief/belief.h"

namespace loci::memory::belief {

/// A believed object as a candidate for an observation. Compact: stored with the scene.
struct Candidate {
  int64_t key = 0, object = 0;            ///< proto object; memory's number, 0 = tentative
  float stay = 0, move = 0, newview = 0;  ///< posterior probabilities
  float similar = 0, proximity = 0;       ///< log-likelihood ratios, same object against unrelated
  float stay_prior = 0, move_prior = 0, newview_prior = 0;  ///< log weights before the evidence
  std::vector<float> distances;                             ///< per Decisions::kinds; NaN = not comparable
  std::vector<float> log_ratios;                            ///< evidence of the distances

  double probability() const { return double(stay) + move + newview; }
};

/// Decision on an observation, and what else was considered.
struct ObservationDecision {
  Explanation explanation = Explanation::stay;
  int64_t key = 0, object = 0;  ///< 0 = clutter or tentative
  float probability = 0, appear = 0, clutter = 0;
  float appear_prior = 0, clutter_prior = 0;  ///< log weights
  std::vector<Candidate> candidates;          ///< most probable first
};

/// Conclusion about an object that was not observed, and what its spot showed (shares of its box).
struct ObjectDecision {
  Explanation explanation = Explanation::stay;
  int64_t key = 0, object = 0;
  float out_of_view = 0, hidden = 0, unmeasured = 0, occupied = 0, seen_through = 0, searched = 0;
  float disappear = 0, missed = 0, out_of_sight = 0;  ///< probabilities
  float here = 0;                                     ///< posterior of being where it was observed last
};

/// All decisions of one scene with their evidence.
struct Decisions {
  std::vector<std::string> kinds;                 ///< of annotations that were compared
  std::vector<ObservationDecision> observations;  ///< in the order of the scene
  std::vector<ObjectDecision> unobserved;         ///< objects whose spot was in view at least in part
  float gate_bound = 0;                           ///< upper bound of the error of a probability
};

Decisions decisions_of(const BeliefUpdate& update);

/// Why a candidate was rejected: a constraint, or the strongest evidence against it.
std::string rejection_reason(const Decisions& decisions, size_t observation, const Candidate& candidate);

/// Pairwise evidence between a scene's observations (rows) and the objects that were candidates or in view
/// (columns). Rounded and compact: stored with the scene. Tables are row-major.
struct SceneMatrices {
  uint32_t rows = 0;
  std::vector<int64_t> keys, objects;           ///< per column: proto object; memory's number, 0 = tentative
  std::vector<std::string> kinds;               ///< of annotations that were compared
  std::vector<std::vector<uint8_t>> distances;  ///< per kind, in steps of kDistanceStep; kNone8
  std::vector<uint16_t> offsets;                ///< between centres, millimetres; kNone16 = farther
  std::vector<uint8_t> similarity;              ///< geometric mean, 254 = 1; kNone8

  static constexpr uint8_t kNone8 = 255;  ///< not comparable
  static constexpr uint16_t kNone16 = 65535;
  static constexpr double kDistanceStep = 0.005;  ///< larger distances are clamped to 254 of them
};

SceneMatrices matrices_of(const BeliefUpdate& update, const Decisions& decisions);

/// Proposals of the single-cue trackers, from what is stored with a scene.
std::vector<TrackerVotes> votes(const SceneMatrices& matrices);

/// How often the arbiter settles an observation, and how often that is the decision.
struct ArbiterCount {
  size_t observations = 0, settled = 0, as_decided = 0;

  void add(const SceneMatrices& matrices, const Decisions& decisions);
};

/// Input and result of one scene, without images: enough to explain it later and to repeat the reasoning.
struct SceneReasoning {
  Scene evidence;  ///< view without camera and images, which are stored with the scene
  Decisions decisions;
  SceneMatrices matrices;
};

}  // namespace loci::memory::belief
