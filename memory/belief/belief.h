#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/belief/evidence/pair_evidence.h"
#include "memory/belief/state.h"
#include "memory/identity/solution.h"

namespace loci::memory::belief {

/// An inferred change of an object, between its last observation and `time`.
struct Event {
  EventKind kind = EventKind::appeared;
  int64_t object = 0;           ///< memory's number
  TimeNs time = 0;              ///< end of the interval: of the scene that showed the change
  std::optional<TimeNs> since;  ///< start of the interval: the last observation before
  double probability = 1;
  std::string from_place, to_place;   ///< empty = unknown or not applicable
  std::optional<AxisBox> from, to;    ///< map frame
  std::optional<size_t> observation;  ///< index in the scene that showed it; unset for unobserved objects
};

/// Probability of a partner of an observation, by explanation.
struct PartnerProbability {
  int64_t key = 0;     ///< of the proto object
  int64_t object = 0;  ///< memory's number; 0 = tentative
  double stay = 0, move = 0, newview = 0;
  double probability() const { return stay + move + newview; }
};

/// Result for an observation: the MAP hypothesis of the scene, and the marginal distribution.
struct ObservationOutcome {
  Explanation explanation = Explanation::appear;
  int64_t key = 0;         ///< proto object; 0 = clutter
  int64_t object = 0;      ///< memory's number; 0 = clutter or tentative
  double probability = 0;  ///< of this partner (or of having appeared), all explanations together
  std::vector<PartnerProbability> partners;  ///< above 0.001, most probable first
  double appear = 0, clutter = 0;
};

/// Result for an object that was believed before the scene.
struct ObjectOutcome {
  int64_t key = 0;
  int64_t object = 0;
  Visibility visibility;
  Explanation explanation = Explanation::hidden;
  double matched = 0, disappear = 0, missed = 0, hidden = 0;  ///< probabilities; sum to one
  double probability_here = 1;  ///< posterior of being where it was observed last
};

/// A tentative object that was confirmed: its number, and its earlier observations.
struct Confirmed {
  int64_t object = 0;
  int64_t key = 0;
  TimeNs first_seen = 0;
  std::vector<PendingObservation> earlier;
};

/// An object that is found where it stood all the time: what was taken for it meanwhile is another one.
struct Mistake {
  int64_t object = 0;  ///< memory's number
  TimeNs since = 0;    ///< when it had been observed there last
};

struct BeliefUpdate {
  std::vector<ObservationOutcome> observations;  ///< in the order of the scene
  std::vector<ObjectOutcome> objects;            ///< those believed before the scene, in the state's order
  std::vector<Confirmed> confirmed;
  std::vector<Event> events;
  std::vector<Mistake> mistakes;  ///< of earlier scenes
  PairEvidence evidence;
  LogOddsProblem problem;  ///< evidence and priors as solved
  double log_evidence = 0;
  /// Of the scene: under what was believed, against nothing in it being related to that.
  double log_likelihood_ratio = 0;
  double gate_bound = 0;  ///< upper bound of the error of all probabilities above
};

/// Updates the belief with one scene. Scenes must not go back in time (Error). Deterministic.
BeliefUpdate advance(BeliefState& state, const Scene& scene, const BeliefOptions& options = {});

}  // namespace loci::memory::belief
