#include "mapping/recording/transform_tree.h"

#include <algorithm>

namespace loci::mapping {
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
