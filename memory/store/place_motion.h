#pragma once

#include <map>
#include <optional>
#include <string>

#include "memory/store/store.h"

namespace loci::memory {

/// Where places stand in the different maps of a memory: furniture that was moved is elsewhere in the map
/// that came after (§10.1, life-long mapping). What lies on it has kept its position on it. Reads a map when
/// it is first asked about.
class PlaceMotions {
 public:
  explicit PlaceMotions(const Store& store) : store_(store) {}

  /// Motion (map frame) of a place from where its row has it to where a map has it. The identity where the
  /// row or the map does not know it, for what a joint moves (each scene knows its joints), and for less than
  /// maps of the same room differ by.
  Isometry3d motion(const PlaceRow& place, std::optional<Id> map);
  /// From where one map has it to where another has it.
  Isometry3d motion(const PlaceRow& place, std::optional<Id> from, std::optional<Id> to);
  /// The origin of its link, map frame; unset where the map does not have it.
  std::optional<Vector3d> position(const PlaceRow& place, Id map);

 private:
  using Poses = std::map<std::string, Isometry3d>;  ///< map_from_link by the name of the link
  const Poses& poses(Id map);

  const Store& store_;
  std::map<Id, Poses> poses_;
};

bool is_moved(const Isometry3d& motion);

}  // namespace loci::memory
