#pragma once

#include <map>
#include <string>

namespace loci {

/// Positions of joints by name, metres or radians; a joint that is not named is at 0.
using JointState = std::map<std::string, double>;

}  // namespace loci
