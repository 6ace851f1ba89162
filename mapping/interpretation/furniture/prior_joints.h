#pragma once

#include <vector>

#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Sets joint and class of a front by its shape and fixture (joint_prior). Without a fixture it has the joint
/// of the most probable way to open, however probable that is, unless it is rather a fixed panel: then it
/// stays as it is.
void set_prior_joint(Front& front);

/// What the neighbours of fronts without fixture show of them: an equal front beside or above it that has one
/// opens in the same way, and upright ones in pairs are the doors of cupboards. They open away from each
/// other (JointEstimate::hinge_from "pair"); of other doors without fixture nothing shows the side of the
/// hinge ("assumed").
void follow_neighbours(std::vector<Front>& fronts);

}  // namespace loci::mapping
