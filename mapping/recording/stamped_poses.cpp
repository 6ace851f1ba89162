#include "mapping/recording/stamped_poses.h"

#include <fmt/format.h>

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

std::string unmatched_because(const std::vector<TimeNs>& depths, const std::vector<TimeNs>& colors) {
  if (depths.empty() || colors.empty()) return {};
  std::vector<TimeNs> delays;
  for (const TimeNs time : depths) {
    const auto after = std::lower_bound(colors.begin(), colors.end(), time);
    const auto before = after == colors.begin() ? after : after - 1;
    const bool is_before = after == colors.end() || time - *before < *after - time;
    delays.push_back((is_before ? *before : *after) - time);
  }
  std::ranges::sort(delays);
  const TimeNs median = delays[delays.size() / 2];
  if (std::abs(median) <= kSameMoment) return {};
  const auto same =
      std::ranges::count_if(delays, [&](TimeNs delay) { return std::abs(delay - median) <= kSameMoment; });
  if (2 * static_cast<size_t>(same) < delays.size()) return {};
  const double seconds = in_seconds(median);
  return fmt::format(
      "colour is stamped {:.3f} s {} than depth: if it was taken with it, give --color-delay-s={:.3f}",
      std::abs(seconds), seconds > 0 ? "later" : "earlier", seconds);
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

namespace {

/// Longer chains are loops.
constexpr size_t kDeepest = 1000;

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child,
                        const StampedPose& parent_from_child, bool is_static) {
  Edge& edge = edges_[child];
  if (edge.parent != parent) edge.poses.clear();
  edge.parent = parent;
  edge.is_static = is_static;
  edge.poses.push_back(parent_from_child);
}

void TransformTree::finish() {
  for (auto& [child, edge] : edges_)
    std::stable_sort(edge.poses.begin(), edge.poses.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.time_ns < b.time_ns; });
}

std::vector<std::string> TransformTree::chain(const std::string& frame) const {
  std::vector<std::string> frames = {frame};
  for (auto edge = edges_.find(frame); edge != edges_.end() && frames.size() < kDeepest;
       edge = edges_.find(frames.back()))
    frames.push_back(edge->second.parent);
  return frames;
}

std::optional<Isometry3d> TransformTree::up_to(const std::string& ancestor, const std::string& frame,
                                               TimeNs time_ns) const {
  Isometry3d pose = Isometry3d::Identity();
  for (std::string at = frame; at != ancestor;) {
    const Edge& edge = edges_.at(at);
    const std::optional<Isometry3d> step =
        edge.is_static ? edge.poses.back().pose : pose_at(edge.poses, time_ns);
    if (!step) return std::nullopt;
    pose = *step * pose;
    at = edge.parent;
  }
  return pose;
}

std::string TransformTree::root_of(const std::string& frame) const {
  return chain(frame).back();
}

bool TransformTree::moves(const std::string& frame) const {
  for (const std::string& each : chain(frame))
    if (const auto edge = edges_.find(each); edge != edges_.end() && !edge->second.is_static) return true;
  return false;
}

std::optional<Isometry3d> TransformTree::root_from(const std::string& frame, TimeNs time_ns) const {
  return up_to(root_of(frame), frame, time_ns);
}

std::optional<Isometry3d> TransformTree::between(const std::string& target, const std::string& source,
                                                 TimeNs time_ns) const {
  const std::vector<std::string> above_target = chain(target);
  for (const std::string& frame : chain(source)) {
    if (std::find(above_target.begin(), above_target.end(), frame) == above_target.end()) continue;
    const auto from_target = up_to(frame, target, time_ns), from_source = up_to(frame, source, time_ns);
    if (!from_target || !from_source) return std::nullopt;
    return from_target->inverse() * *from_source;
  }
  return std::nullopt;
}

}  // namespace loci::mapping
