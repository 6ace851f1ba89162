#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/tracking/alignment.h"
#include "mapping/tracking/pose_graph.h"

namespace loci::mapping::tracking {

/// s; after a longer gap between frames the velocity of the camera is not known.
inline constexpr double kMaxGap = 1.0;
/// Objections for which there is advice of their own.
inline constexpr const char* kHardlyAnyDepth = "there is hardly any depth in range";
inline constexpr const char* kUndetermined = "the surfaces in view do not determine the pose";

/// A frame that is ready to be tracked.
struct PreparedFrame {
  size_t number = 0;
  TimeNs time_ns = 0;
  FrameImages images;
  Features features;
  std::optional<Isometry3d> given;  ///< a pose to refine
  bool is_damaged = false;          ///< its depth image cannot be read
};

/// Where a frame is relative to a keyframe, or why that is not known.
struct FrameResult {
  std::optional<size_t> keyframe;  ///< may be set although there is an objection: then the pose is a guess
  Isometry3d keyframe_from_camera = Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of a small motion (translation, rotation) in the camera frame
  std::string objection;                   ///< empty when the pose is good
};

/// Follows the camera frame by frame against keyframes, and keeps these consistent in a pose graph. The first
/// frame with enough depth has the identity, or its given pose.
///
/// Keyframes that alignments connect in all directions are a *part*. Where the surfaces in view do not
/// determine the pose, tracking goes on by the motion of the camera, and another part begins; when the camera
/// is lost, it begins anew in another *region*, whose pose in the map is not known. Loops join them.
class Tracker {
 public:
  FrameResult add(PreparedFrame frame);

  /// Final poses of the keyframes.
  const std::vector<Isometry3d>& map_from_keyframes() const { return map_from_keyframes_; }
  /// Whether each keyframe belongs to the part with the most frames.
  std::vector<bool> in_main_part() const;
  size_t loops() const { return loops_; }

 private:
  /// A pose that fits, and what it was aligned with.
  struct Located {
    Alignment alignment;
    std::vector<size_t> references;  ///< best overlap first
    double best_overlap = 0;
    bool determined = true;
  };

  /// What a frame at a pose would see of one part.
  struct View {
    size_t part = 0;
    std::vector<size_t> keyframes;  ///< best overlap first
    double best_overlap = 0;
  };

  std::vector<View> views_at(const FrameImages& images, const Isometry3d& pose, size_t region) const;
  /// Whether a part is that of the last frame.
  bool is_of_last(const View& view) const;
  std::vector<Reference> with_poses(const std::vector<size_t>& keyframes) const;
  /// A prior says that the frame follows the last one: then less must agree.
  std::optional<Located> try_pose(const PreparedFrame& frame, const Isometry3d& guess, size_t region,
                                  const PosePrior* prior);
  std::optional<Located> locate(const PreparedFrame& frame);
  std::optional<Located> relocalise(const PreparedFrame& frame);
  std::vector<Isometry3d> guesses_for(const PreparedFrame& frame) const;
  /// Whether a pose is near what is known of the motion: the frame comes soon after the last one, or corners
  /// of both match.
  bool motion_is_known(const PreparedFrame& frame, const Isometry3d& pose) const;
  PosePrior predicted(const PreparedFrame& frame) const;
  bool too_fast(const PreparedFrame& frame, const Isometry3d& pose) const;
  bool wants_keyframe(const Located& located) const;
  /// Whether the last keyframe is among what a pose was aligned with.
  bool is_newest(const Located& located) const;
  FrameResult begin_region(PreparedFrame frame);
  void add_keyframe(PreparedFrame frame, const Isometry3d& pose, size_t region);
  void extend(PreparedFrame frame, const Located& located);
  bool constrain(const FrameImages& images, size_t keyframe, const Isometry3d& guess, double min_inliers,
                 const LevelRange& levels);
  /// As constrain, but neither view may see through what the other shows: equal fronts agree where both see
  /// them, but their surroundings differ.
  bool constrain_loop(const FrameImages& images, size_t keyframe, const Isometry3d& guess);
  void close_loops(const FrameImages& images, const Features& features, const Isometry3d& pose,
                   size_t region);
  void join_regions();
  void join_parts(size_t a, size_t b);
  size_t part_of(size_t keyframe) const;
  /// Good frames, by the keyframe that stands for a part.
  std::vector<size_t> frames_of_parts() const;
  void index(size_t keyframe);
  void remember(const PreparedFrame& frame, const Isometry3d& pose, size_t region);

  std::vector<std::unique_ptr<Keyframe>> keyframes_;
  std::vector<Isometry3d> map_from_keyframes_;
  std::vector<size_t> region_;    ///< of each keyframe
  std::vector<size_t> part_;      ///< of each keyframe: another keyframe of its part, in the end itself
  std::vector<size_t> attached_;  ///< good frames that refer to each keyframe
  std::vector<PoseConstraint> constraints_;
  AppearanceIndex appearance_;
  std::vector<size_t> indexed_;  ///< keyframes in the order of the index
  size_t regions_ = 0;
  size_t loops_ = 0;
  size_t lost_ = 0;  ///< frames in a row

  /// The last frame with a pose.
  struct Last {
    TimeNs time_ns = 0;
    size_t number = 0;
    Isometry3d pose = Isometry3d::Identity();
    size_t region = 0;
    std::optional<size_t> keyframe;  ///< that it refers to, if its pose is determined
    Features features;
    std::optional<Isometry3d> given;
    std::optional<Vector6d> velocity;  ///< per second, in the camera frame
  };
  std::optional<Last> last_;
  std::optional<Isometry3d> matched_;  ///< pose of the frame by corners that it shares with the last one
  std::string objection_;              ///< to the last attempt
  std::optional<Located> sliding_;     ///< a pose of the frame that fits, but may slide along the surfaces
};

}  // namespace loci::mapping::tracking
