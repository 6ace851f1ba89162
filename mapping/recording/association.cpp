#include "mapping/recording/association.h"

#include <algorithm>
#include <cstdlib>

namespace loci::mapping {

std::vector<std::optional<size_t>> nearest_in_time(const std::vector<TimeNs>& times,
                                                   const std::vector<TimeNs>& others) {
  std::vector<std::optional<size_t>> result;
  for (const TimeNs time : times) {
    const auto after = std::lower_bound(others.begin(), others.end(), time);
    std::optional<size_t> nearest;
    for (const auto& each : {after, after == others.begin() ? after : after - 1}) {
      if (each == others.end() || std::abs(*each - time) > kSameMoment) continue;
      const auto position = static_cast<size_t>(each - others.begin());
      if (!nearest || std::abs(*each - time) < std::abs(others[*nearest] - time)) nearest = position;
    }
    result.push_back(nearest);
  }
  return result;
}

std::optional<Isometry3d> pose_at(const std::vector<StampedPose>& poses, TimeNs time_ns) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), time_ns,
                       [](const StampedPose& pose, TimeNs time) { return pose.time_ns < time; });
  if (after != poses.end() && after->time_ns == time_ns) return after->pose;
  if (after == poses.end() || after == poses.begin() || after->time_ns - (after - 1)->time_ns > kLongestGap) {
    for (const auto& each : {after, after == poses.begin() ? after : after - 1})
      if (each != poses.end() && std::abs(each->time_ns - time_ns) <= kSameMoment) return each->pose;
    return std::nullopt;
  }
  const StampedPose& a = *(after - 1);
  const StampedPose& b = *after;
  const double part = static_cast<double>(time_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(a.pose.linear()).slerp(part, Eigen::Quaterniond(b.pose.linear()));
  Isometry3d pose(turn.normalized());
  pose.translation() = (1 - part) * a.pose.translation() + part * b.pose.translation();
  return pose;
}

}  // namespace loci::mapping
