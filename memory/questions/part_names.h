#pragma once

#include <map>
#include <optional>
#include <string>

#include "mapping/base/time.h"

namespace loci::mapping {
struct World;
}  // namespace loci::mapping

namespace loci::memory {

class Store;

/// The program of runs that are edits by people.
inline constexpr const char* kEditProgram = "loci-memory edit";

/// What people called links and joints of the map. Links that are places are not among them: a place has its
/// name as a fact (place_names.h). These are rows of the table run alone: edits whose configuration has
/// "part": {"of": "link" or "joint", "name": the map's, "before", "after": people's, "" = none}.
struct PartNames {
  std::map<std::string, std::string> links = {}, joints = {};  ///< by the map's name

  /// As people call it, else as the map does.
  const std::string& link(const std::string& name) const;
  const std::string& joint(const std::string& name) const;
};

/// As known now, or at a time.
PartNames part_names(const Store& store, std::optional<TimeNs> known_at = {});

/// Gives a map's links and joints these names.
void take_part_names(mapping::World& world, const PartNames& names);

}  // namespace loci::memory
