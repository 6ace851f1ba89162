#pragma once

#include <string>

#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// The tree of links and joints as SVG (Fig. 7.11): links are boxes, joints that move ellipses; fronts light
/// blue, handles green, supports blue, drawer bottoms red, moving joints orange. `root` is the link to start
/// from; empty = the map's root. Error when there is no such link.
std::string link_graph_svg(const World& world, const SemanticMap& semantics, const std::string& root);

}  // namespace loci::mapping
