#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/belief/options.h"
#include "memory/belief/similarity.h"
#include "memory/belief/state.h"
#include "memory/belief/trackers.h"
#include "memory/identity/solution.h"

namespace loci::memory::belief {

/// Something that happened to an object, as far as the belief can tell. It happened between the object's last
/// sighting and `time`.
struct Event {
  EventKind kind = EventKind::appeared;
  int64_t object = 0;           ///< memory's number
  TimeNs time = 0;              ///< until when it happened: of the scene that showed it
  std::optional<TimeNs> since;  ///< after which it happened: the last look before
  double probability = 1;
  std::string from_place, to_place;   ///< empty = unknown or does not apply
  std::optional<AxisBox> from, to;    ///< map frame
  std::optional<size_t> observation;  ///< index in the scene that showed it; unset for what was not seen
};

/// One term of an association distribution.
struct Share {
  int64_t key = 0;     ///< of the proto object
  int64_t object = 0;  ///< memory's number; 0 = tentative
  double stay = 0, move = 0, newview = 0;
  double probability() const { return stay + move + newview; }
};

/// What an observation is taken to be: the decision (one story for the whole scene) and the distribution.
struct ObservationOutcome {
  Explanation explanation = Explanation::appear;
  int64_t key = 0;            ///< proto object; 0 = taken for clutter
  int64_t object = 0;         ///< memory's number; 0 = clutter or tentative
  double probability = 0;     ///< of this partner (or of having appeared), all explanations together
  std::vector<Share> shares;  ///< above 0.001, most probable first
  double appear = 0, clutter = 0;
};

/// What became of a believed object in this scene.
struct ObjectOutcome {
  int64_t key = 0;
  int64_t object = 0;
  Visibility visibility;
  Explanation explanation = Explanation::hidden;
  double matched = 0, disappear = 0, missed = 0, hidden = 0;  ///< probabilities; sum to one
  double probability_here = 1;                                ///< afterwards, of being where it was seen last
};

/// Evidence between believed objects (rows, in the order of BeliefUpdate::objects) and observations
/// (columns). What is settled is not compared with what is out of view: it has no distances to that.
struct PairEvidence {
  struct Distances {
    std::string kind;
    PairTable distance;   ///< NaN = not comparable
    PairTable log_ratio;  ///< what it tells; 0 = not comparable
  };
  std::vector<Distances> distances;
  PairTable offset;     ///< between the centres, metres
  PairTable closeness;  ///< the dissertation's similarity in [0,1]; NaN = nothing to compare
  PairTable log_similar, log_proximity;
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> colorless;  ///< neither has colour
  PairTable log_size;               ///< the part of log_similar that is about size; 0 = not comparable
  std::vector<TrackerVotes> votes;  ///< per observation
  std::vector<std::optional<size_t>> settled;  ///< row of the object that an observation is without question
};

/// An object that became certain enough to be told: its number, and its earlier sightings.
struct Confirmed {
  int64_t object = 0;
  int64_t key = 0;
  TimeNs first_seen = 0;
  std::vector<PendingSighting> earlier;
};

struct BeliefUpdate {
  std::vector<ObservationOutcome> observations;  ///< in the order of the scene
  std::vector<ObjectOutcome> objects;            ///< those believed before the scene, in the state's order
  std::vector<Confirmed> confirmed;
  std::vector<Event> events;
  PairEvidence evidence;
  LogOddsProblem problem;  ///< evidence and priors as they were solved
  double log_evidence = 0;
  double gate_bound = 0;  ///< largest error of a probability above
};

/// Moves the belief on by one scene. Scenes must not go back in time (Error). Deterministic.
BeliefUpdate advance(BeliefState& state, const Scene& scene, const BeliefOptions& options = {});

/// The box of an object in the map frame, its place being where `places` says.
AxisBox box_in_map(const ProtoObject& object, const std::vector<PlacePose>& places);

}  // namespace loci::memory::belief
