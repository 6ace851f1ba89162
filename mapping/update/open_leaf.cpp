#include "mapping/update/open_leaf.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/articulation/moved_face.h"
#include "mapping/update/parameters.h"

namespace loci::mapping {
namespace {

/// From where a part is with its joint at a position to where it is with the joint closed.
Isometry3d closed_from_open(const JointEstimate& joint, double position) {
  const Motion motion{joint.type, joint.axis.normalized(), joint.origin, position};
  return motion.moved_from_closed().inverse();
}

/// The part of a front that moves farthest per unit of its joint, metres.
double lever_of(const Front& front) {
  const JointEstimate& joint = *front.joint;
  if (joint.type == ArticulationType::prismatic) return 1;
  double lever = 0;
  for (const double side : {-0.5, 0.5})
    for (const double end : {-0.5, 0.5}) {
      const Vector3d corner =
          front.centre + side * front.width * front.right() + end * front.height * front.up;
      lever = std::max(lever, joint.axis.normalized().cross(corner - joint.origin).norm());
    }
  return lever;
}

/// In the axes of a front: to its right, up, out of it.
Vector3d in_front(const Front& front, const Vector3d& point) {
  const Vector3d d = point - front.centre;
  return {d.dot(front.right()), d.dot(front.up), d.dot(front.normal)};
}

bool within(const Front& front, const Vector3d& place) {
  return std::abs(place.x()) < front.width / 2 + kChanges.front_gap_m &&
         std::abs(place.y()) < front.height / 2 + kChanges.front_gap_m;
}

/// The cells of a panel that surfels cover with the joint at a position.
size_t covered_cells(const Front& front, double position, const registration::Surfels& surface,
                     const std::vector<uint32_t>& candidates) {
  const Isometry3d back = closed_from_open(*front.joint, position);
  std::set<std::pair<int, int>> cells;
  for (const uint32_t i : candidates) {
    const Vector3d place = in_front(front, back * surface.position[i].cast<double>());
    const bool on_panel =
        place.z() < kChanges.front_gap_m && place.z() > -kChanges.leaf_m - kChanges.front_gap_m;
    if (on_panel && within(front, place))
      cells.insert({static_cast<int>(std::floor(place.x() / kChanges.leaf_cell_m)),
                    static_cast<int>(std::floor(place.y() / kChanges.leaf_cell_m))});
  }
  return cells.size();
}

OpenLeaf leaf_at(const Front& front, double position, const registration::Surfels& surface,
                 const std::vector<uint32_t>& candidates) {
  OpenLeaf leaf{position, {}, 0};
  const Isometry3d back = closed_from_open(*front.joint, position);
  const double drawn_out = front.joint->type == ArticulationType::prismatic
                               ? position * front.joint->axis.normalized().dot(front.normal)
                               : 0;
  for (const uint32_t i : candidates) {
    const Vector3d point = surface.position[i].cast<double>();
    const Vector3d moved = in_front(front, back * point), at_rest = in_front(front, point);
    // A handle stands before the panel. Behind the closed place is what the front hid, which may be wider
    // than the front; before it the box of a drawer.
    const bool on_panel = within(front, moved) && moved.z() < kChanges.swept_margin_m &&
                          moved.z() > -kChanges.leaf_m - kChanges.front_gap_m;
    const bool inside = at_rest.z() < 0 || (within(front, at_rest) && at_rest.z() < drawn_out);
    if (!on_panel && !inside) continue;
    leaf.surfels.push_back(i);
    leaf.on_panel += on_panel ? 1 : 0;
  }
  return leaf;
}

}  // namespace

std::optional<OpenLeaf> open_leaf(const Front& front, const registration::Surfels& surface,
                                  const std::vector<uint32_t>& candidates, double min_share) {
  if (!front.joint || front.joint->type == ArticulationType::rigid) return std::nullopt;
  const double lever = lever_of(front);
  const double step = kChanges.leaf_step_m / lever, first = kChanges.min_leaf_m / lever;
  // The ends of joints are assumed, or found to some centimetres.
  const double last = front.joint->upper + kChanges.swept_margin_m / lever;
  double best = 0;
  size_t most = 0;
  for (double position = std::max(first, front.joint->lower); position <= last; position += step)
    if (const size_t cells = covered_cells(front, position, surface, candidates); cells > most) {
      most = cells;
      best = position;
    }
  const double all = front.width * front.height / (kChanges.leaf_cell_m * kChanges.leaf_cell_m);
  if (static_cast<double>(most) < min_share * all) return std::nullopt;
  return leaf_at(front, best, surface, candidates);
}

}  // namespace loci::mapping
