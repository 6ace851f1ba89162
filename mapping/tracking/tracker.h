#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/tracking/alignment.h"
#include "mapping/tracking/pose_graph.h"

namespace loci::mapping::tracking {

/// A frame that is ready to be tracked.
struct PreparedFrame {
  size_t number = 0;
  TimeNs time_ns = 0;
  FrameImages images;
  Features features;
  std::optional<Isometry3d> given;  ///< a pose to refine
};

/// Where a frame is relative to a keyframe, or why that is not known.
struct FrameResult {
  std::optional<size_t> keyframe;
  Isometry3d keyframe_from_camera = Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of a small motion (translation, rotation) in the camera frame
  std::string objection;                   ///< empty when the pose is good
};

/// Follows the camera frame by frame against keyframes, and keeps these consistent in a pose graph. The first
/// frame with enough depth has the identity, or its given pose.
class Tracker {
 public:
  FrameResult add(PreparedFrame frame);

  /// Final poses of the keyframes.
  const std::vector<Isometry3d>& map_from_keyframes() const { return map_from_keyframes_; }
  size_t loops() const { return loops_; }

 private:
  /// A pose that passed all tests, and what it was aligned with.
  struct Located {
    Alignment alignment;
    std::vector<size_t> references;  ///< best overlap first
    double best_overlap = 0;
  };

  std::vector<size_t> references_at(const FrameImages& images, const Isometry3d& pose,
                                    double* best_overlap) const;
  std::vector<Reference> with_poses(const std::vector<size_t>& keyframes) const;
  std::optional<Located> try_pose(const PreparedFrame& frame, const Isometry3d& guess, double min_inliers);
  std::optional<Located> locate(const PreparedFrame& frame);
  std::optional<Located> relocalise(const PreparedFrame& frame);
  std::vector<Isometry3d> guesses_for(const PreparedFrame& frame) const;
  Isometry3d predicted(const PreparedFrame& frame) const;
  bool too_fast(const PreparedFrame& frame, const Isometry3d& pose) const;
  bool wants_keyframe(const Located& located) const;
  void add_keyframe(PreparedFrame frame, const Located* located);
  bool constrain(const FrameImages& images, size_t keyframe, const Isometry3d& guess, double min_inliers,
                 const LevelRange& levels);
  void close_loops(const FrameImages& images, const Features& features);
  void remember(const PreparedFrame& frame, const Isometry3d& pose);

  std::vector<std::unique_ptr<Keyframe>> keyframes_;
  std::vector<Isometry3d> map_from_keyframes_;
  std::vector<PoseConstraint> constraints_;
  AppearanceIndex appearance_;
  size_t loops_ = 0;

  /// The last frame with a pose.
  struct Last {
    TimeNs time_ns = 0;
    size_t number = 0;
    Isometry3d pose = Isometry3d::Identity();
    Features features;
    std::optional<Isometry3d> given;
    Vector6d velocity = Vector6d::Zero();  ///< per second, in the camera frame
  };
  std::optional<Last> last_;
  std::string objection_;  ///< to the last attempt
  std::optional<Isometry3d>
      undetermined_;  ///< pose of a lost frame that fits, but may slide along the surfaces
};

}  // namespace loci::mapping::tracking
