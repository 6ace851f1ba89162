#pragma once

#include <optional>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/base/time.h"

namespace loci::mapping {

// Streams that were recorded side by side, each with stamps of its own.

/// Colour and depth, or depth and pose, belong together when their stamps differ by no more than this: less
/// than a frame at 30 Hz.
inline constexpr TimeNs kSameMoment = 20'000'000;
/// Poses further apart than this are not interpolated.
inline constexpr TimeNs kLongestGap = kSecond / 2;

/// For each time of `times` the position in `others` (ascending) of the nearest one; unset when that is
/// further away than kSameMoment.
std::vector<std::optional<size_t>> nearest_in_time(const std::vector<TimeNs>& times,
                                                   const std::vector<TimeNs>& others);

struct StampedPose {
  TimeNs time_ns = 0;
  Isometry3d pose = Isometry3d::Identity();
};

/// The pose at a time between the two that surround it (straight line, great arc); the nearest one within
/// kSameMoment outside; unset where neither is near enough. `poses` ascend in time.
std::optional<Isometry3d> pose_at(const std::vector<StampedPose>& poses, TimeNs time_ns);

}  // namespace loci::mapping
