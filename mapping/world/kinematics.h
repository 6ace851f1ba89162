#pragma once

#include <vector>

#include "mapping/world/world.h"

namespace loci::mapping {

/// The pose of every link in the root's frame, by index into world.links. Mimic joints follow the joint that
/// they mimic, whatever the state says of them; a joint that the state does not name is at 0. A state that
/// names an unknown joint or a value that is not finite is an Error.
std::vector<Isometry3d> root_from_links(const World& world, const JointState& state);

/// Those of a state's joints that the world has. A robot reports its own joints beside those of the
/// furniture.
JointState joints_of_world(const World& world, JointState state);

/// Motion of a joint at a position: rotation about, or translation along, its axis (normalised here). Fixed
/// joints do not move; floating and planar joints have no single position and stay at their origin.
Isometry3d joint_motion(const Joint& joint, double position);

/// The nearest joint above a link that moves; nullptr where none does.
const Joint* moving_joint(const World& world, const std::string& link);

/// Whether a movable joint lies between each link and the root, by index into world.links.
std::vector<bool> moving_links(const World& world);

}  // namespace loci::mapping
