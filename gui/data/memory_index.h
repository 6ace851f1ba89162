#pragma once

#include <map>
#include <unordered_map>

#include "gui/data/browser_data.h"
#include "memory/questions/map_names.h"
#include "memory/store/store.h"

namespace loci::gui {

/// What of a memory is at hand at all times: names, scenes, events, the map.
struct MemoryIndex {
  MemoryInfo info = {};
  memory::PartNames parts = {};
  std::map<memory::Id, std::string> places = {};
  std::map<memory::Id, std::string> aliases = {}, classes = {}, owners = {};
  std::vector<SceneEntry> scenes = {};                          ///< in the order of time
  std::unordered_map<memory::Id, size_t> number_of_scene = {};  ///< its index in scenes
  std::vector<EventEntry> events = {};                          ///< in the order of time
  std::shared_ptr<const mapping::World> world = {};             ///< null = none
  std::vector<PlaceOutline> loose_places = {};
  memory::Id last_scene = 0;  ///< the highest number of a scene

  const std::string* name_of_place(std::optional<memory::Id> id) const;  ///< nullptr = unknown
  std::string name_of(memory::Id object) const;                          ///< alias, else "object_12"
};

/// Reads it. `before` (may be null) is what the same file said earlier: while one run goes on adding scenes,
/// only those after it are read. Interrupted when it is told to stop.
MemoryIndex read_index(const memory::Store& store, const MemoryIndex* before, Progress& progress);

}  // namespace loci::gui
