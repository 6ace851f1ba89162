#pragma once

#include <filesystem>

#include "memory/store/store.h"

namespace loci::memory {

// The maps of a memory in the order of time. A scene is seen in the map that it was perceived with, or
// without one in that of the scene before; the room of a moment is that of the latest scene. So a map may
// also come between recordings, without a look.

/// Adds a map (URDF, with the sidecar beside it) unless the memory has it. Error when it cannot be read, and
/// when its walls are not those of the map before: a memory is of one home.
Id add_map(Store& store, const std::filesystem::path& urdf);

/// The room as it is from a time on.
struct MapPeriod {
  Id map = 0;
  std::string name = {};                ///< of the file
  TimeNs from = 0;                      ///< of the first scene with it
  int64_t scenes = 0;                   ///< until the next map
  std::vector<std::string> moved = {};  ///< places that stood elsewhere in the map before
};
/// In order of time; scenes without a map do not count.
std::vector<MapPeriod> map_periods(const Store& store);

/// From a time on the room is as in this map, although nobody looked: a scene without a camera is recorded,
/// and what lies on furniture that moved has moved along. Nothing is added where the last scene has this map.
/// Error when the file cannot be read as a map, in an empty memory, and when `at` is not after the last
/// scene: later scenes were perceived with another map.
void enter_map(Store& store, const std::filesystem::path& urdf, TimeNs at, const std::string& program);

}  // namespace loci::memory
