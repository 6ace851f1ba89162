#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/world/world.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/store/store.h"

namespace loci::gui {

/// What people call objects, places and parts of the map, and what they said about objects; as it holds now.
struct Names {
  std::map<memory::Id, std::string> labels = {}, classes = {}, owners = {};  ///< by object
  std::map<memory::Id, std::string> places = {};
  std::map<memory::Id, std::string> joint_of_place = {};  ///< of those that a joint moves
  memory::PartNames parts = {};
  size_t believed = 0;  ///< objects that there are, whether gone or not

  std::string object(memory::Id id) const;                       ///< the best name known, else "object_12"
  std::string class_of(memory::Id object) const;                 ///< empty = unknown
  std::string owner_of(memory::Id object) const;                 ///< empty = unknown
  std::string place(const std::optional<memory::Id>& id) const;  ///< empty = unknown
};

/// What the memory knew before a run added to it.
struct KnownState {
  TimeNs known_at = 0;
  std::string before = {};  ///< "before: loci-memory edit (object_3 is object_2)"
};

struct MemoryInfo {
  std::string path = {};
  std::string schema = {};  ///< "1.0"
  TimeZone zone;            ///< for showing times
  bool time_assumed = false;
  std::string summary = {};  ///< one line: scenes, objects, events
  size_t runs = 0;           ///< that wrote to it; while these are the same, it only grows at its end
  std::vector<KnownState> known = {};  ///< oldest first
};

/// The part of a memory that is kept in RAM: names, scenes, events, the map.
struct MemoryIndex {
  MemoryInfo info = {};
  std::shared_ptr<const Names> names = {};
  std::vector<memory::SceneRow> scenes = {};                            ///< in order of time
  std::unordered_map<memory::Id, size_t> number_of_scene = {};          ///< its index in scenes
  std::vector<memory::Change> events = {};                              ///< in order of time
  std::map<TimeNs, std::shared_ptr<const mapping::World>> worlds = {};  ///< the map from a time on
  std::vector<memory::PlaceRow> loose_places = {};  ///< with height and outline, not drawn by a map
  memory::Id last_scene = 0;                        ///< the highest id of a scene

  /// nullptr = unknown.
  const memory::SceneRow* scene(const std::optional<memory::Id>& id) const;
};

/// Reads it. `before` (may be null) is an earlier index of the same file: while one run goes on adding
/// scenes, only those after it are read. Interrupted when the progress says stop.
MemoryIndex read_index(const memory::Store& store, const MemoryIndex* before, Progress& progress);

}  // namespace loci::gui
