#pragma once

#include <optional>
#include <vector>

#include "mapping/world/world.h"
#include "memory/store/store.h"

namespace loci::memory {

/// The fact of a place that says what it is called instead of what the map or the planes called it.
inline constexpr const char* kPlaceNameKey = "name";

/// Gives places the names that people gave them; `facts` are those that hold.
void take_place_names(std::vector<PlaceRow>& places, const std::vector<FactRow>& facts);
/// All places by the names that hold now.
std::vector<PlaceRow> named_places(const Store& store);
/// The newest map, as corrected, its places, links and joints by the names that hold now; unset when there is
/// none.
std::optional<mapping::World> named_map(const Store& store);

}  // namespace loci::memory
