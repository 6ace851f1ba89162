#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// Frame of poses that start at the first frame's camera.
inline constexpr const char* kFirstCamera = "first_camera";

struct TrackingOptions {
  int every = 1;
  bool refine = false;
  int threads = 0;  ///< 0 = all cores; the result is the same on any number

  void declare(OptionTable& table);
};

/// What is known of the camera's pose at one frame.
struct TrackedFrame {
  size_t number = 0;  ///< in the recording
  int64_t index = 0;
  TimeNs time_ns = 0;
  std::optional<Isometry3d> map_from_camera;  ///< unset = lost
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of a small motion
                                            ///< (translation in m, rotation in rad) in the camera frame
  std::string objection;                    ///< why the frame is lost
};

struct TrackingResult {
  std::vector<TrackedFrame> frames;  ///< every n-th of the recording
  std::string map_frame;             ///< of the poses: "map" only when given poses were refined there
  size_t keyframes = 0;
  size_t loops = 0;    ///< places recognised by their appearance
  bool still = false;  ///< the camera stands still: all good frames have the same pose
  /// The depth camera's fixed error: measured minus true inverse depth (CV_32F, 1/m), over the depth image at
  /// a lower resolution, without its mean, which is hardly known; empty = none found.
  cv::Mat depth_offsets;
  double depth_offset = 0;  ///< RMS of what tracking leaves out, mean included
  /// Of depth, σ = this · z², 1/m; estimated where most frames are lost, else 0.
  double depth_noise = 0;
  double seconds = 0;
  double cpu_seconds = 0;

  size_t good() const;
  /// Most frames are lost, and depth is too noisy for their surfaces to be compared.
  bool too_noisy() const;
  /// Of all frames of a recording of that size: unset where the frame is lost or was not tracked.
  std::vector<std::optional<Isometry3d>> poses(size_t recording_size) const;
  std::string summary() const;
  Json report() const;
};

/// Poses of the camera from the images alone: dense alignment with keyframes, loop closure and a pose graph.
/// The map frame is the camera at the first frame. With `refine`, given poses are the start, and the map
/// frame is theirs. What is lost is said and has no pose. Same result on any number of threads. Error when
/// the recording has no frames, when no frame has depth, or with `refine` when no frame has a pose.
TrackingResult track(const Recording& recording, const TrackingOptions& options, Progress& progress);

/// Error when fewer than a tenth of the frames are good, or of several only one, with the reasons.
void require_usable(const TrackingResult& result, const std::string& path);

/// The recording with the poses of its tracking, and without the fixed error of its depth that tracking has
/// found: at 4 m it is several centimetres, and what is seen from far alone would lie beside itself. Refined
/// poses stay in their frame; others come into the frame "odom", at the first camera and z up. With a
/// warning, and not levelled, where neither the recording nor a plane in view says which way is up.
std::unique_ptr<Recording> with_tracked_poses(std::unique_ptr<Recording> recording,
                                              const TrackingResult& result, bool refined, Warnings& warnings);

}  // namespace loci::mapping
