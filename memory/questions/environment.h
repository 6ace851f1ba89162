#pragma once

#include <map>
#include <set>

#include "mapping/base/text/json_fwd.h"
#include "mapping/world/world.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// The furniture and what opens: room, opens. From the map's links, what scenes saw of them, and the objects
// there.

struct Question;
struct Reply;
struct ReplyContext;
class Snapshot;
std::vector<Question> environment_questions();

/// The map that the last scene was seen with; unset without one.
std::optional<mapping::World> world_of(const Snapshot& snapshot);
/// The part of the map of this name that is no place; "" = none.
std::string find_part_without_place(const Snapshot& snapshot, const std::string& name);
/// Places by their height among those of their kind: "top drawer", "middle shelf"; empty for other names.
std::vector<Id> find_places_by_level(const Snapshot& snapshot, const std::string& name);
/// The map's joints that move the parts of this name.
std::set<std::string> joints_called(const Snapshot& snapshot, const std::string& name);
/// Whether a scene of the period knows the position of a joint.
bool is_joint_seen(const Store& store, const std::string& joint, AsOf as_of, std::optional<TimeNs> from,
                   std::optional<TimeNs> to);

/// The joint of a part and its state.
struct PartMotion {
  std::string joint = {};
  std::string map_joint = {};  ///< what the map calls it
  mapping::JointType type = mapping::JointType::fixed;
  double lower = 0, upper = 0;                     ///< metres or radians; 0 = closed
  std::optional<double> position = {};             ///< in the last scene that knew; unset = never known
  std::optional<SceneRef> seen = {};               ///< that scene
  std::optional<Change> opened = {}, closed = {};  ///< the last time of each
  /// In the first scene that knew after the time asked about, where no scene of that minute did.
  std::optional<double> next_position = {};
  std::optional<SceneRef> next_seen = {};  ///< that scene
  /// A position is open from a twentieth of the range on.
  bool is_open(double at) const;
  /// At the time asked about. Unset where no look showed it, and where it changed between the look before and
  /// the look after.
  std::optional<bool> open() const;
};

struct EnvironmentPart {
  std::string name = {};      ///< of the link, or of a place that no map has
  std::string map_name = {};  ///< what the map calls it
  std::string class_name = {};
  std::vector<std::string> aliases = {};  ///< with its appliance
  std::optional<Vector3d> position = {};  ///< map frame, as the map was made
  std::optional<Vector3d> size = {};      ///< of its solid shapes along the axes of its link, metres
  std::optional<PartMotion> motion = {};
  // Where objects can be on or in it.
  std::optional<PlaceRef> place = {};
  std::optional<double> height = {};  ///< of its surface above the floor
  size_t objects = 0;                 ///< believed to be there
  std::optional<SceneRef> last_view = {};
};

// ---- room

struct RoomQuestion {
  std::string part = {};  ///< link, place, alias, appliance or class; empty = all
  AsOf as_of = {};
  std::string state = {};  ///< "empty" or "in use": only places that were looked at and are so; empty = all
};
struct RoomAnswer {
  std::string asked = {}, state = {};
  std::string map = {};                        ///< its file name; empty = no map, only places that were found
  std::map<std::string, size_t> classes = {};  ///< number of parts
  std::vector<EnvironmentPart> parts = {};     ///< in the order of their names
};
/// UnknownName with the nearest names for an unknown part; so for opens.
RoomAnswer ask(const Store& store, const RoomQuestion& question);
std::string to_text(const RoomAnswer& answer, const TimeWriter& times);
void write_reply(const RoomAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const RoomAnswer& answer);

// ---- opens

struct OpensQuestion {
  std::string part = {};  ///< as for the room
  /// "open" or "closed": only those; "unopened": only those that did not open in the period; empty = all
  std::string state = {};
  AsOf as_of = {};
  std::optional<TimeNs> from = {}, to = {};
};
struct OpensAnswer {
  std::string asked = {};
  std::string state = {};
  std::vector<EnvironmentPart> parts = {};
  // With a state: those that are not so, and those of which no look shows whether they are.
  std::vector<EnvironmentPart> others = {}, not_observed = {};
};
OpensAnswer ask(const Store& store, const OpensQuestion& question);
std::string to_text(const OpensAnswer& answer, const TimeWriter& times);
void write_reply(const OpensAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const OpensAnswer& answer);

}  // namespace loci::memory
