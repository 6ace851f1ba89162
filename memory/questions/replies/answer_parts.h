#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

// What answers are composed of. Every answer is a struct with its evidence; command line, browser, report and
// JSON render the same struct.

struct SceneRef {
  Id scene = 0;
  TimeNs time = 0;
  std::optional<std::string> recording = {};
  std::optional<int64_t> frame = {};  ///< index in the recording
};

struct ObjectRef {
  Id id = 0;
  std::string name = {};  ///< "object_12"
  std::vector<std::string> aliases = {};
  std::optional<std::string> color = {};
  std::optional<Vector3d> size = {};  ///< metres
  /// The best name known: alias, else product, else class; what people state before what annotators do. Unset
  /// = none.
  std::optional<std::string> label = {};
};

struct PlaceRef {
  Id id = 0;
  std::string name = {};
  bool container = false;  ///< objects are in it rather than on it
};

/// Another location of an object: an observation there was associated with another object.
struct AlternativeLocation {
  double probability = 0;
  std::optional<PlaceRef> place = {};
  std::optional<Vector3d> position = {};
  SceneRef scene = {};
  std::optional<ObjectRef> taken_for = {};  ///< unset = a false detection
};

/// What is believed about an object.
struct ObjectBelief {
  ObjectRef object = {};
  ObjectStatus status = ObjectStatus::seen;
  double probability = 0;  ///< that it is at this place
  double in_home = 0;      ///< that it is at this place or elsewhere in the home
  std::optional<PlaceRef> place = {};
  std::optional<Vector3d> position = {};  ///< map frame
  std::optional<SceneRef> first_seen = {};
  std::optional<SceneRef> last_seen = {};
  size_t sightings = 0;
  // Scenes since it was last seen, by what they showed of its place.
  size_t scenes_out_of_view = 0;
  size_t scenes_hidden = 0;
  size_t scenes_missed = 0;
  std::optional<SceneRef> last_missed = {};  ///< the last scene that saw its place without it
  /// Since it was last seen, that scene included; only `where` fills them.
  std::vector<AlternativeLocation> alternatives = {};
};

/// An event.
struct Change {
  EventKind kind = EventKind::appeared;
  TimeNs time = 0;
  std::optional<TimeNs> since = {};  ///< it happened after this time and until `time`
  std::optional<ObjectRef> object = {};
  std::optional<PlaceRef> place = {};
  std::optional<PlaceRef> from_place = {};
  std::optional<Vector3d> position = {};
  std::optional<Vector3d> from_position = {};
  std::optional<std::string> joint = {};
  bool joint_is_named = false;  ///< by people, not by the map
  std::optional<double> joint_position = {};
  std::optional<double> from_joint_position = {};
  double probability = 1;
  std::optional<SceneRef> scene = {};
  std::string source = {};
};

/// Whether a change of a joint opens it further.
bool is_opening(const Change& change);

enum class Verdict { yes, no, not_observed };
std::string to_text(Verdict verdict);  ///< "yes", "no", "not_observed"

/// "object_3 (red, called tea cup)".
std::string to_text(const ObjectRef& object);
/// Without its time: "object_3 (red) moved from table_1 to counter_1".
std::string to_text(const Change& change);

}  // namespace loci::memory
