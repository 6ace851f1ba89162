#pragma once

#include <filesystem>

#include "mapping/recording/file_recording.h"

namespace loci::mapping {

// Small files beside recordings that other layouts than ours use.

/// A file beside the images or one folder above; empty when there is none.
std::filesystem::path beside_or_above(const std::filesystem::path& folder, const char* name);

/// A 4 x 4 matrix of 16 numbers. Error when they are no pose.
Isometry3d read_pose_file(const std::filesystem::path& path);

/// cameras.yaml: `depth` with size, f, c and optionally `unit_m` and `invalid`, optional `color` and
/// `color_from_depth` (R, t). Fills cameras, depth scale and invalid values.
void read_cameras(const std::filesystem::path& path, FileRecordingContent& content);

}  // namespace loci::mapping
