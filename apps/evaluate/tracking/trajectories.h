#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/recording/recording.h"

namespace loci::apps::tracking_evaluation {

/// Camera poses by frame number of a recording; frames without pose are not there.
using Trajectory = std::map<size_t, Isometry3d>;

/// Frames from `first` to `last` (exclusive), every n-th.
struct FrameRange {
  size_t first = 0, last = SIZE_MAX, every = 1;
};

/// Methods that run beside ours.
struct Peers {
  bool opencv = true;
  bool open3d = false;  ///< an error where it was not built
};

/// One method over one recording.
struct Row {
  std::string recording, method;
  size_t frames = 0, good = 0;
  double ate_rmse_m = 0, ate_max_m = 0;     ///< after rigid alignment of the positions
  double relative_m = 0, relative_deg = 0;  ///< RMS over a second
  size_t relative_pairs = 0;
  size_t false_good = 0;  ///< good, but off by more than 10 cm
  double surface_m = 0;   ///< RMS distance of depth images half a second apart; needs no reference
  double cpu_ms = 0;      ///< per frame, reading included
  double frames_per_second = 0;
};

/// Tracks a recording with our tracker and, as `peers` says, OpenCV's RgbdICPOdometry and Open3D's RGB-D
/// odometry (if installed), and compares all with its poses, which are not used otherwise. The last row is of
/// the reference itself: how well it fits the depth images.
std::vector<Row> compare_trackers(const std::string& recording, const FrameRange& range, const Peers& peers,
                                  int threads, Progress& progress);

std::string to_text(const std::vector<Row>& rows);
Json to_json(const std::vector<Row>& rows);

}  // namespace loci::apps::tracking_evaluation
