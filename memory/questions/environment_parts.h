#pragma once

#include <set>

#include "mapping/world/world.h"
#include "memory/questions/replies/answer_parts.h"

namespace loci::memory {

// The furniture of a room as questions see it: the map's links, what scenes saw of them, and places that no
// map has.

class Snapshot;

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
  std::vector<std::string> pieces = {};  ///< links that its joint moves along: the bottom, sides, a handle
  // Where objects can be on or in it.
  std::optional<PlaceRef> place = {};
  std::optional<PlaceRow> unseen_place = {};  ///< that the map has, where no scene has added it yet
  std::optional<double> height = {};          ///< of its surface above the floor
  size_t objects = 0;                         ///< believed to be there
  std::optional<SceneRef> last_view = {};
};

/// All parts, without their motions and contents; Snapshot::parts() keeps them.
std::vector<EnvironmentPart> all_parts(const Snapshot& snapshot);
/// Parts that are called so exactly: by a name of their own, of their joint, place or pieces ("drawer_2" is
/// drawer_2_front), or by an alias or appliance. Empty where none is.
std::vector<EnvironmentPart> parts_named(const Snapshot& snapshot, const std::string& name);
/// Parts that a name means, without their motions and contents: a link, place, alias, appliance or class;
/// "" = all. UnknownName with the nearest names when it means none.
std::vector<EnvironmentPart> find_parts(const Snapshot& snapshot, const std::string& name);
/// What the last words of a name are taken for where no part is called by all of them: "drawer" for "fridge
/// drawer". Empty where its words say which part is meant ("top drawer"), and where it means none.
std::string kind_meant(const Snapshot& snapshot, const std::string& name);
/// Adds how their joints stood when they were seen last, when they opened and closed, and what is there.
void add_states(const Snapshot& snapshot, std::vector<EnvironmentPart>& parts);

/// The file name of the map at the time asked about; "" = none.
std::string map_name(const Snapshot& snapshot);
/// The map that the last scene was seen with; unset without one.
std::optional<mapping::World> world_of(const Snapshot& snapshot);
/// The part of the map of this name that scenes have not made a place of; unset without one.
std::optional<EnvironmentPart> find_part_without_place(const Snapshot& snapshot, const std::string& name);
/// Places by their height among those of their kind: "top drawer", "middle shelf"; empty for other names.
std::vector<Id> find_places_by_level(const Snapshot& snapshot, const std::string& name);
/// The map's joints that move the parts of this name.
std::set<std::string> joints_called(const Snapshot& snapshot, const std::string& name);
/// Whether a scene of the period knows the position of a joint.
bool is_joint_seen(const Store& store, const std::string& joint, AsOf as_of, std::optional<TimeNs> from,
                   std::optional<TimeNs> to);

}  // namespace loci::memory
