#pragma once

#include <vector>

#include "mapping/world/world.h"

namespace loci {

/// The pose of every link in the root's frame, by index into world.links. Mimic joints follow; a joint that
/// the state does not name is at 0; a state that names an unknown joint is an Error.
std::vector<Isometry3d> root_from_links(const World& world, const JointState& state);

/// Motion of a joint at a position: rotation about, or translation along, its axis.
Isometry3d joint_motion(const Joint& joint, double position);

}  // namespace loci
