#pragma once

#include <memory>

#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// The recording, with tracked poses when it has none of its own and its camera moves. A camera that stands
/// still, and a few images of different scenes, stay without. Warns that it tracked. Error when the camera is
/// lost too often, or which way is up is not known.
std::unique_ptr<Recording> with_known_poses(std::unique_ptr<Recording> recording, int threads,
                                            Progress& progress, Warnings& warnings);

}  // namespace loci::mapping
