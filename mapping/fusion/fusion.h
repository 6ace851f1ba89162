#pragma once

#include "mapping/base/math/tally.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

struct FusionOptions {
  int every = 1;
  double voxel_m = 0.01;
  double range_max_m = 4.0;
  int min_observations = 2;
  int frames_per_scan = 20;
  bool edge_filter = true;
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);
};

struct FusionResult {
  ScanSet scans;
  Tally frames;                   ///< used, and why others were left out
  Tally without_color;            ///< of those used: whose colour images cannot be read
  size_t pixels_at_edges = 0;     ///< left out: between foreground and background, or alone
  size_t voxels_seldom_seen = 0;  ///< left out: fewer frames than min_observations
  double seconds = 0;

  size_t points() const;
  std::string summary() const;
  Json report() const;
};

/// Fuses depth frames with poses into a scan set: consecutive frames become one scan of voxels. A voxel has
/// the mean position of its points, weighted by range, their colour, and the nearest origin; measurements
/// beyond range_max are stored as rays without return. Frames without pose or depth are skipped and counted.
/// The scan's frame is the camera's of its middle frame. Same result on any number of threads. Error with the
/// reasons when no frame could be used.
FusionResult fuse(const Recording& recording, const FusionOptions& options, Progress& progress);

/// Sets pixels to NaN that stand between a nearer and a farther neighbour, or with fewer than three of the
/// eight neighbours near their depth: flying pixels. Returns how many. `depth` is CV_32F, metres.
size_t drop_flying_pixels(cv::Mat& depth);

}  // namespace loci::mapping
