#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/world/world.h"
#include "memory/store/run_configuration.h"
#include "memory/store/store.h"

namespace loci::memory {

// Names that people gave to places and to parts of the map. A place has its name as a fact; links and joints
// have theirs in the rows of the table run: edits whose configuration has "part": {"of": "link" or "joint",
// "name": the map's, "before", "after": people's, "" = none}.

/// The key of the fact that renames a place.
inline constexpr const char* kPlaceNameKey = "name";

/// Error unless a text can be the name of a place, link or joint: 1 to 100 bytes of UTF-8 that begin and end
/// with no blank, without control characters, without `<`, `>`, `&`, `"` and without `--`, which would end or
/// break an element, attribute or comment of a map.
void require_part_name(const std::string& name);

/// Names of links and joints that are no places, by the map's name.
struct PartNames {
  std::map<std::string, std::string> links = {}, joints = {};

  /// As people call it, else as the map does.
  const std::string& link(const std::string& name) const;
  const std::string& joint(const std::string& name) const;
};

/// As known now, or at a time.
PartNames part_names(const Store& store, std::optional<TimeNs> known_at = {});

/// Renames places; `facts` are those that hold.
void rename_places(std::vector<PlaceRow>& places, const std::vector<FactRow>& facts);
/// All places by the names that hold now.
std::vector<PlaceRow> named_places(const Store& store);
/// The map as of a time, its places, links and joints by the names that hold now; unset when there is none.
std::optional<mapping::World> named_map(const Store& store, const AsOf& as_of = {});

}  // namespace loci::memory
