#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/json.h"
#include "memory/belief/observation.h"
#include "memory/belief/options.h"

namespace loci::belief {

enum class Status {
  tentative,  ///< seen too rarely to be told from a false cluster; nobody is told
  present,    ///< believed to be where it was seen last (perhaps hidden or out of view)
  gone,       ///< looked for and not there
};

/// One way an object looked, and how often it looked like that.
struct Look {
  std::vector<Descriptor> descriptors;
  double weight = 1;
  TimeNs time = 0;
  bool partial = false;
};

/// An observation that was attributed to a tentative object, to be told when it is confirmed.
struct PendingSighting {
  int64_t observation = 0;  ///< memory's number
  TimeNs time = 0;
  bool first = false;      ///< it made the object; otherwise it was found again
  double probability = 0;  ///< of the attribution
};

/// A proto object: what a bag of observations adds up to (§3.2.5).
struct ProtoObject {
  int64_t key = 0;  ///< within the belief; never reused
  int64_t id = 0;   ///< the memory's object number; 0 while tentative
  Status status = Status::tentative;
  TimeNs first_seen = 0;
  TimeNs last_seen = 0;
  TimeNs last_update = 0;  ///< of the scene that last told anything about it
  double attention_s = 0;  ///< BeliefState::attention_s then: the clock for which probability_here holds
  int sightings = 0;
  double exists_log_odds = 0;   ///< of being an object and no false cluster
  double probability_here = 1;  ///< that it still is where it was seen last
  int hidden_looks = 0;         ///< scenes in a row in which something stood in front of it
  bool told_hidden = false;     ///< an event said so and no sighting has followed

  std::string place;     ///< what it stands on; empty = unknown
  AxisBox box;           ///< fused; centre in the place's frame, size along the map's axes
  double variance = 0;   ///< of the centre per axis, m²
  bool partial = false;  ///< never seen whole since it is there
  bool sized = true;     ///< somebody measured its size
  Isometry3d map_from_camera = Isometry3d::Identity();  ///< of the last sighting

  std::vector<Look> looks;
  int64_t last_observation = 0;          ///< memory's number
  std::vector<PendingSighting> pending;  ///< while tentative
};

/// All that the belief carries from one scene to the next.
struct BeliefState {
  std::vector<ProtoObject> objects;  ///< in the order in which they were first seen
  std::optional<TimeNs> last_scene;
  double attention_s =
      0;  ///< seconds during which things could be handled; time that was watched counts less
  int64_t next_key = 1;
  int64_t next_id = 1;

  const ProtoObject* find(int64_t id) const;
};

/// Probability that an object was handled in so many seconds of attention (see BeliefState::attention_s).
double handled_in(double seconds, const BeliefOptions& options);
/// Probability that an object still is where it was seen last, as of the last scene.
double probability_here(const ProtoObject& object, const BeliefState& state, const BeliefOptions& options);

/// Text round trip is exact: every double comes back as it was.
Json to_json(const BeliefState& state);
BeliefState belief_state_from_json(const Json& json);

/// Compact bytes of the same (CBOR).
std::string to_bytes(const BeliefState& state);
/// Error when the bytes are not a belief of this version.
BeliefState belief_state_from_bytes(const std::string& bytes);

}  // namespace loci::belief
