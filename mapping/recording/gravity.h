#pragma once

#include <optional>
#include <string>

#include "mapping/recording/recording.h"

namespace loci::mapping {

/// The direction that is up, unit: in the frame of the poses, or, without poses, in the camera of the first
/// frame that shows enough. It is the normal of the floor or of a table that is seen from above; a camera is
/// taken as held upright unless such a plane is much larger for one that is held sideways or upside down.
/// Unset when no plane stands out.
std::optional<Vector3d> find_up(const Recording& recording);

/// "x", "-y" …, or three numbers with commas. Error for anything else.
Vector3d parse_direction(const std::string& text);

}  // namespace loci::mapping
