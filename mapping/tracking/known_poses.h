#pragma once

#include <memory>

#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// What a recording without poses is tracked for.
enum class PosesFor {
  perception,  ///< a camera that stands still, and a few images of different scenes, stay without; z must be
               ///< up
  placement,   ///< in a map: poses are needed in any case, a camera that stands still has one; z must be up
  mapping      ///< poses are needed in any case; what is up may be found later
};

/// The recording, with tracked poses when it has none of its own. Warns that it tracked. Error when the
/// camera is lost too often, or, for perception, which way is up is not known.
std::unique_ptr<Recording> with_known_poses(std::unique_ptr<Recording> recording, PosesFor purpose,
                                            int threads, Progress& progress, Warnings& warnings);

/// A recording without poses of a camera that stood still: all its frames have one pose, in the frame "odom"
/// at the camera, z up. Error where which way is up is not known.
std::unique_ptr<Recording> with_fixed_pose(std::unique_ptr<Recording> recording, Warnings& warnings);

}  // namespace loci::mapping
