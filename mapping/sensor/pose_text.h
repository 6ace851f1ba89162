#pragma once

#include <string>
#include <vector>

#include "mapping/sensor/laser.h"

namespace loci::mapping {

/// Poses from "x,y,yaw_deg; x,y,yaw_deg; …", at least one. Error that begins with `what` and names the part
/// that is none.
std::vector<PlanarPose> planar_poses_from(const std::string& text, const std::string& what);

}  // namespace loci::mapping
