#pragma once

#include <map>

#include "mapping/world/world.h"
#include "memory/questions/answers.h"

namespace loci::memory {

// What the room consists of and what opens: the map's links, what scenes saw of them, and what stands there.

class Snapshot;

/// The map that the last scene was seen with; unset without one.
std::optional<mapping::World> world_of(const Snapshot& snapshot);

/// How a part moves, and how it stands.
struct PartMotion {
  std::string joint = {};
  std::string map_joint = {};  ///< what the map calls it
  mapping::JointType type = mapping::JointType::fixed;
  double lower = 0, upper = 0;                     ///< metres or radians; 0 = closed
  std::optional<double> position = {};             ///< in the last scene that knew; unset = never known
  std::optional<SceneRef> seen = {};               ///< that scene
  std::optional<Change> opened = {}, closed = {};  ///< the last time of each
  bool open() const;                               ///< by a twentieth of its way at least
};

struct RoomPart {
  std::string name = {};      ///< of the link, or of a place that no map has
  std::string map_name = {};  ///< what the map calls it
  std::string class_name = {};
  std::vector<std::string> aliases = {};  ///< with its appliance
  std::optional<Vector3d> position = {};  ///< map frame, as the map was made
  std::optional<PartMotion> motion = {};
  // Where things can be on or in it.
  std::optional<PlaceRef> place = {};
  std::optional<double> height = {};  ///< of its surface above the floor
  size_t objects = 0;                 ///< believed to be there
  std::optional<SceneRef> last_look = {};
};

struct RoomQuestion {
  std::string part = {};  ///< link, place, alias, appliance or class; empty = all
  AsOf as_of = {};
};
struct RoomAnswer {
  std::string asked = {};
  std::string map = {};  ///< its file name; empty = there is none, only places that were found
  std::map<std::string, size_t> classes = {};  ///< how many parts of each
  std::vector<RoomPart> parts = {};            ///< in the order of their names
};

/// What opens.
struct OpensQuestion {
  std::string part = {};  ///< as for the room
  AsOf as_of = {};
};
struct OpensAnswer {
  std::string asked = {};
  std::vector<RoomPart> parts = {};
};

/// The part of the map that is called so although it is no place where things were looked for; "" = none.
std::string part_without_place(const Snapshot& snapshot, const std::string& name);

// A part that nobody knows is an UnknownName with the nearest names.
RoomAnswer ask(const Store& store, const RoomQuestion& question);
OpensAnswer ask(const Store& store, const OpensQuestion& question);

}  // namespace loci::memory
