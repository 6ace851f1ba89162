#pragma once

#include <string>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

/// Names of the colours that the latest observations of an object show on at least a tenth of it, the one
/// with most of it first; empty where no annotator named them. From above, a blue bowl that is white inside
/// shows white, then blue.
std::vector<std::string> seen_colors(const Store& store, Id object, const AsOf& as_of);

}  // namespace loci::memory
