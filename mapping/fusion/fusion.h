#pragma once

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "mapping/sensor/scan.h"

namespace loci {

struct FusionOptions {
  int every = 1;
  double voxel_m = 0.01;
  double range_max_m = 4.0;
  int min_observations = 2;
  int frames_per_scan = 20;
  int threads = 0;

  void declare(OptionTable& table);
};

struct FusionResult {
  ScanSet scans;
  size_t frames_used = 0;
  size_t frames_without_pose = 0;
  std::string summary() const;
};

/// Posed depth frames to a scan set: consecutive frames become one scan, thinned to voxels; a voxel keeps the
/// mean of its points, its colour and the origin that saw it best. Frames without pose are left out and
/// counted.
FusionResult fuse(const Recording& recording, const FusionOptions& options, Progress& progress);

}  // namespace loci
