#pragma once

#include <string>
#include <vector>

#include "mapping/recording/recording.h"

namespace loci::mapping {

/// How well the depth of neighbouring frames agrees under the poses.
struct PoseAgreement {
  size_t compared = 0;  ///< pixels that fall into the other frame, of the pairs that agree least
  double share = 0;     ///< of them, those that meet the surface that it measured
  std::string cause;    ///< what the poses probably are instead: "from the world to the camera"; empty when
                        ///< nothing that was tried agrees much better
  std::string hint;     ///< what to do about it
  double gain = 1;      ///< of that: so many times as much agrees then, or as little does depth differ
  double difference_m = 0;  ///< of the depth between frames, where the cause is in it
  bool in_depth = false;    ///< the cause is in depth or its camera, not in the poses
  bool never_move = false;  ///< the poses; the camera does

  bool fits() const;
  /// One line; empty when the poses fit.
  std::string text() const;
};

/// Reads some pairs of frames. Poses that do not fit are tried the other way round, with the quaternion in
/// another order, in another unit, of other axes, and later or earlier by some frames; also depth that meets
/// itself roughly is tried with other focal lengths and units, as distance along rays, and mirrored.
PoseAgreement check_poses(const Recording& recording);

/// Another direction that is up in what is seen than z of the poses, or, without poses, than the options say:
/// a line that names it.
std::optional<std::string> doubt_about_up(const Recording& recording, const RecordingOptions& options);

/// A line where most frames have no depth, by some of them.
std::optional<std::string> missing_depth(const Recording& recording);

/// A line where what some frames see is higher than a room: depth without given poses is in another unit
/// then. z is up.
std::optional<std::string> implausible_height(const Recording& recording);

/// Lines for people about a recording that was opened with these options: about poses that do not fit the
/// depth, by check_poses(), or else by doubt_about_up().
std::vector<std::string> doubts_about_poses(const Recording& recording, const PoseAgreement& agreement,
                                            const RecordingOptions& options);
std::vector<std::string> doubts_about_poses(const Recording& recording, const RecordingOptions& options);

/// All that is odd about a recording: RecordingInfo::problems, missing_depth() and the doubts.
std::vector<std::string> problems_of(const Recording& recording, const RecordingOptions& options);

}  // namespace loci::mapping
