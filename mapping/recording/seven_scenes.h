#pragma once

#include <filesystem>

#include "mapping/recording/file_recording.h"

namespace loci::mapping {

/// Whether a folder holds a sequence in the layout of 7-Scenes (*.depth.png).
bool is_seven_scenes(const std::filesystem::path& folder);

/// Reads *.depth.png, *.color.*, *.pose.txt (4x4, camera to world); cameras.yaml and world_to_map.txt beside
/// them or one folder above. Without cameras.yaml the cameras are taken as a Kinect's.
FileRecordingContent read_seven_scenes(const std::filesystem::path& folder);

}  // namespace loci::mapping
