#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/math/tally.h"
#include "mapping/base/progress.h"
#include "mapping/recording/markers.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// Layouts that recordings are written in.
enum class RecordingFormat { loci, mcap, tum };

struct ConvertOptions {
  RecordingFormat format = RecordingFormat::loci;
  int every = 1;                              ///< takes every n-th frame
  std::vector<std::filesystem::path> inputs;  ///< what the same command reads; never replaced
  bool force = false;                    ///< may replace a recording or MCAP file that loci did not write
  std::vector<MarkerLayer> layers = {};  ///< drawn over the recording; MCAP only
};

/// Writes a recording in another layout; frames whose depth cannot be read are left out.
///   loci  the folder that loci reads fastest
///   mcap  one file for ROS 2, Foxglove and Rerun: depth and colour with their cameras, tf, joints, markers
///   tum   the folder of the TUM RGB-D benchmark; poses are those of the depth camera
/// What was there before is replaced only if loci wrote it, and stays when this fails.
Tally convert_recording(const Recording& recording, const std::filesystem::path& out,
                        const ConvertOptions& options, Progress& progress);

}  // namespace loci::mapping
