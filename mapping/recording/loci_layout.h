#pragma once

#include <filesystem>

#include "mapping/base/config.h"
#include "mapping/recording/file_recording.h"

namespace loci::mapping {

/// Reads our own layout: recording.yaml, frames.csv, and if they are there joints.csv and transforms.csv.
FileRecordingContent read_loci_layout(const std::filesystem::path& folder);

/// Fields of a pinhole camera from a map (width, height, fx, fy, cx, cy); the caller finishes the map.
PinholeCamera read_pinhole(const Config& config);

}  // namespace loci::mapping
