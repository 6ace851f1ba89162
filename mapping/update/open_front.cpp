#include "mapping/update/open_front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/update/motion.h"
#include "mapping/update/open_leaf.h"
#include "mapping/update/parameters.h"

namespace loci::mapping {
namespace {

/// How the surface of a closed front is seen now, in surfels.
struct FaceNow {
  size_t all = 0, still = 0, through = 0;
};

FaceNow face_now(const Front& front, const Epoch& before, const Epoch& now) {
  FaceNow face;
  for (uint32_t i = 0; i < before.surface().size(); ++i) {
    if (!on_front(front, before.surface().position[i])) continue;
    ++face.all;
    const SurfaceState state = now.state_of(before.surface().position[i], before.surface().normal[i]);
    face.still += state == SurfaceState::same ? 1 : 0;
    face.through += state == SurfaceState::free ? 1 : 0;
  }
  return face;
}

/// Unexplained surfels in the space that a front sweeps.
std::vector<uint32_t> swept_by(const Front& front, const Epoch& now,
                               const std::vector<uint8_t>& unexplained) {
  std::vector<uint32_t> swept;
  const bool slides = front.joint && front.joint->type == ArticulationType::prismatic;
  const double out = (slides ? front.depth : std::max(front.width, front.height)) + kChanges.swept_margin_m;
  const double beside = slides ? kChanges.swept_margin_m : std::max(front.width, front.height);
  for (uint32_t i = 0; i < now.surface().size(); ++i) {
    if (unexplained[i] == 0) continue;
    const Vector3d d = now.surface().position[i].cast<double>() - front.centre;
    const double before = d.dot(front.normal);
    if (before > -front.depth - kChanges.swept_margin_m && before < out &&
        std::abs(d.dot(front.right())) < front.width / 2 + beside &&
        std::abs(d.dot(front.up)) < front.height / 2 + kChanges.swept_margin_m)
      swept.push_back(i);
  }
  return swept;
}

}  // namespace

std::optional<OpenFront> open_front(const Front& front, const Visit& before, const Visit& now,
                                    const std::vector<uint8_t>& unexplained) {
  const FaceNow face = face_now(front, before.epoch, now.epoch);
  const std::vector<uint32_t> swept = swept_by(front, now.epoch, unexplained);
  if (face.all < kPieces.min_surfels / 2 || swept.size() < kPieces.min_surfels / 2) return std::nullopt;
  const auto share = [&](double of_face) { return of_face * static_cast<double>(face.all); };
  if (static_cast<double>(face.still) > share(1 - kChanges.min_front_open)) return std::nullopt;
  // What stands before a closed door hides it; an open one lets one look in.
  const bool turns = front.joint && front.joint->type == ArticulationType::revolute;
  const bool passed = static_cast<double>(face.through) >= share(kChanges.min_front_through);
  DifferenceResult moved;
  if (!turns || passed) moved = articulate(before.scans, now.scans, front, {}, DifferenceOptions{});
  if (moved.joint)
    return OpenFront{*moved.joint, moved.moved, moved.joint->probabilities[1] + moved.joint->probabilities[2],
                     fmt::format("{} points of the moved front", moved.points), swept};
  const auto leaf = open_leaf(front, now.epoch.surface(), swept,
                              turns && passed ? kChanges.min_edge_share : kChanges.min_leaf_share);
  if (!leaf) return std::nullopt;
  return OpenFront{*front.joint, leaf->position, change_probability(static_cast<double>(leaf->on_panel)),
                   fmt::format("{} surfels where its joint takes it", leaf->on_panel), leaf->surfels};
}

bool on_front(const Front& front, const Eigen::Vector3f& position) {
  const Vector3d d = position.cast<double>() - front.centre;
  return std::abs(d.dot(front.normal)) < kChanges.front_gap_m &&
         std::abs(d.dot(front.right())) < front.width / 2 && std::abs(d.dot(front.up)) < front.height / 2;
}

}  // namespace loci::mapping
