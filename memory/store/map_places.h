#pragma once

#include <optional>
#include <string>

#include "mapping/base/error.h"
#include "mapping/world/semantic_map.h"
#include "memory/store/rows/rows.h"

namespace loci::memory {

/// The place that a link of a map is: one with a height and an outline, on or in which objects can be; unset
/// for other links. Its map, joint and pose are not set. Error at `sidecar` for a height or an outline of
/// another form.
std::optional<PlaceRow> place_of_link(const std::string& name, const mapping::SemanticLink& link,
                                      const std::string& sidecar);

}  // namespace loci::memory
