#pragma once

#include <string>

#include "mapping/base/error.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// A world as SDF 1.7 (Gazebo): one model that is fixed to the world, with the same names. Links of mere
/// structure (no shape, no mass, fixed) become frames of the same name. What SDF does not have is warned
/// about and left out: mimic joints move on their own, planar joints are fixed.
std::string sdf_text(const World& world, Warnings& warnings);

}  // namespace loci::mapping
