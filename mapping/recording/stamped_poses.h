#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"

namespace loci::mapping {

/// Colour and depth, or depth and pose, belong together when their stamps differ by no more than this: less
/// than a frame at 30 Hz.
inline constexpr TimeNs kSameMoment = 20'000'000;
/// Poses further apart than this are not interpolated.
inline constexpr TimeNs kLongestGap = kSecond / 2;

/// For each time of `times` the position in `others` (ascending) of the nearest one; unset when that is
/// further away than kSameMoment.
std::vector<std::optional<size_t>> nearest_in_time(const std::vector<TimeNs>& times,
                                                   const std::vector<TimeNs>& others);

/// A line for RecordingInfo::problems where the stamps of colour are off those of depth by the same for most
/// frames, and by too much to be matched: what to set. Empty otherwise.
std::string unmatched_because(const std::vector<TimeNs>& depths, const std::vector<TimeNs>& colors);

struct StampedPose {
  TimeNs time_ns = 0;
  Isometry3d pose = Isometry3d::Identity();
};

/// The pose at a time between the two that surround it (straight line, great arc); the nearest one within
/// kSameMoment outside; unset where neither is near enough. `poses` ascend in time.
std::optional<Isometry3d> pose_at(const std::vector<StampedPose>& poses, TimeNs time_ns);

/// Coordinate frames as in tf: a tree whose edges have poses over time.
class TransformTree {
 public:
  /// Static transforms hold at all times. A frame that gets another parent keeps the last one.
  void add(const std::string& parent, const std::string& child, const StampedPose& parent_from_child,
           bool is_static);
  /// Call after the last add().
  void finish();

  /// The frame above all others that `frame` hangs on; itself when it hangs on nothing.
  std::string root_of(const std::string& frame) const;
  /// Whether a transform between the frame and its root is not static.
  bool moves(const std::string& frame) const;
  /// Unset where an edge of the chain has no pose near the time.
  std::optional<Isometry3d> root_from(const std::string& frame, TimeNs time_ns) const;
  /// target_from_source, independent of motion above their common parent. Unset for frames of different
  /// trees.
  std::optional<Isometry3d> between(const std::string& target, const std::string& source,
                                    TimeNs time_ns) const;

 private:
  struct Edge {
    std::string parent;
    bool is_static = false;
    std::vector<StampedPose> poses;
  };
  /// The frame and all above it, up to the root.
  std::vector<std::string> chain(const std::string& frame) const;
  std::optional<Isometry3d> up_to(const std::string& ancestor, const std::string& frame,
                                  TimeNs time_ns) const;

  std::map<std::string, Edge> edges_;  ///< by child
};

}  // namespace loci::mapping
