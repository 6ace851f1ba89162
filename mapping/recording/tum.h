#pragma once

#include "mapping/recording/file_recording.h"

namespace loci::mapping {

/// Whether a folder has the lists of the TUM RGB-D benchmark: depth.txt, and rgb.txt or groundtruth.txt.
bool is_tum(const std::filesystem::path& folder);

/// Reads the TUM RGB-D layout: `depth.txt` and `rgb.txt` (stamp, file), `groundtruth.txt` (stamp, x y z qx qy
/// qz qw of the colour camera, with which depth is registered). Each depth image takes the nearest colour
/// image and the pose at its time.
FileRecordingContent read_tum(const std::filesystem::path& folder);

}  // namespace loci::mapping
