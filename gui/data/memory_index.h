#pragma once

#include <map>
#include <unordered_map>

#include "gui/data/browser_data.h"
#include "memory/questions/part_names.h"
#include "memory/store/store.h"

namespace loci {

/// What of a memory is at hand at all times: names, scenes, events, the map.
struct MemoryIndex {
  MemoryInfo info = {};
  PartNames parts = {};
  std::map<Id, std::string> places = {};
  std::map<Id, std::string> aliases = {}, classes = {}, owners = {};
  std::vector<SceneEntry> scenes = {};                  ///< in the order of time
  std::unordered_map<Id, size_t> number_of_scene = {};  ///< its index in scenes
  std::vector<EventEntry> events = {};                  ///< in the order of time
  std::shared_ptr<const World> world = {};              ///< null = none
  std::vector<PlaceOutline> loose_places = {};
  Id last_scene = 0;  ///< the highest number of a scene

  const std::string* name_of_place(std::optional<Id> id) const;  ///< nullptr = unknown
  std::string name_of(Id object) const;                          ///< alias, else "object_12"
};

/// Reads it. `before` (may be null) is what the same file said earlier: while one run goes on adding scenes,
/// only those after it are read. Interrupted when it is told to stop.
MemoryIndex read_index(const Store& store, const MemoryIndex* before, Progress& progress);

}  // namespace loci
