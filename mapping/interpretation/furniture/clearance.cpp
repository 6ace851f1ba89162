#include "mapping/interpretation/furniture/clearance.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/furniture/cabinets.h"
#include "mapping/interpretation/furniture/front_fit.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/world/contacts.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

using Bounds = Eigen::AlignedBox3d;

/// What moves together, and how certain it is that the map has it in the right place.
struct Part {
  std::vector<size_t> links;
  int rank = 0;  ///< inferred bodies below fronts below all else …
  bool moved = false;
  double confidence = 0;  ///< … and fronts by these

  bool gives_way_to(const Part& other) const {
    return std::tuple(rank, moved, confidence) < std::tuple(other.rank, other.moved, other.confidence);
  }
};

/// The links below one, and it.
std::vector<size_t> links_below(const std::string& name, const World& world) {
  std::vector<size_t> links = {world.link_index(name)};
  for (size_t i = 0; i < links.size(); ++i)
    for (const Joint& joint : world.joints)
      if (joint.parent == world.links[links[i]].name) links.push_back(world.link_index(joint.child));
  return links;
}

/// The front that a link belongs to with all its links; a link of something else alone.
Part part_of(const std::string& name, const std::vector<Front>& fronts, const World& world,
             const SemanticMap& semantics) {
  const size_t link = world.link_index(name);
  for (const Front& front : fronts) {
    const std::optional<std::string> panel = front_link(front.name, semantics);
    if (!panel) continue;
    std::vector<size_t> links = links_below(*panel, world);
    if (std::ranges::find(links, link) != links.end())
      return {std::move(links), 1, front.joint && front.joint->evidence != "prior", front.confidence};
  }
  const auto found = semantics.links.find(name);
  return {{link}, found != semantics.links.end() && is_inferred_cabinet(found->second) ? 0 : 2};
}

/// The poses of a link seen from another one while either of them opens and all else is closed; poses that
/// follow each other in a path are near each other, or apart by a shift.
std::vector<std::vector<Isometry3d>> paths_between(const World& world, size_t from, size_t to) {
  std::vector<std::vector<Isometry3d>> paths;
  for (const size_t moving : {from, to}) {
    const Joint* joint = moving_joint(world, world.links[moving].name);
    if (joint == nullptr || !joint->limits) continue;
    const double upper = joint->limits->upper;
    const int steps =
        joint->type == JointType::prismatic ? 1 : std::max(1, static_cast<int>(std::ceil(upper / kDegree)));
    std::vector<Isometry3d>& path = paths.emplace_back();
    for (int k = 0; k <= steps; ++k) {
      const std::vector<Isometry3d> root_from = root_from_links(world, {{joint->name, upper * k / steps}});
      path.push_back(root_from[from].inverse() * root_from[to]);
    }
  }
  return paths;
}

/// What remains of a solid outside of what others pass on their paths.
std::vector<Bounds> rest_of(const SolidBox& solid, const std::vector<SolidBox>& others,
                            const std::vector<std::vector<Isometry3d>>& paths) {
  const Vector3d gap = Vector3d::Constant(kCabinets.clearance_m);
  const Isometry3d solid_from_link = solid.link_from_box.inverse();
  std::vector<Bounds> pieces = {Bounds(-solid.half, solid.half)};
  for (const SolidBox& other : others)
    for (const std::vector<Isometry3d>& path : paths)
      for (size_t k = 0; k + 1 < path.size(); ++k) {
        const Bounds passed = bounds_of(other, solid_from_link * path[k])
                                  .merged(bounds_of(other, solid_from_link * path[k + 1]));
        std::vector<Bounds> rest;
        for (const Bounds& piece : pieces) cut_out({passed.min() - gap, passed.max() + gap}, piece, rest);
        pieces = std::move(rest);
      }
  return pieces;
}

/// Cuts the collision shapes of a link so that it and another one pass each other.
void give_way(size_t yielding, size_t staying, World& world) {
  std::vector<SolidBox> solids, others;
  for (const SolidBox& box : solid_boxes(world)) {
    if (box.link == yielding) solids.push_back(box);
    if (box.link == staying) others.push_back(box);
  }
  if (solids.empty() || others.empty()) return;
  const std::vector<std::vector<Isometry3d>> paths = paths_between(world, yielding, staying);
  std::vector<Collision> left;
  size_t next = 0;  // of the solids: meshes are none
  for (const Collision& shape : world.links[yielding].collisions) {
    if (std::holds_alternative<Mesh>(shape.geometry)) {
      left.push_back(shape);
      continue;
    }
    const SolidBox& solid = solids[next++];
    const std::vector<Bounds> pieces = rest_of(solid, others, paths);
    if (pieces.size() == 1 && pieces[0].isApprox(Bounds(-solid.half, solid.half))) {
      left.push_back(shape);
      continue;
    }
    for (const Bounds& piece : pieces)
      left.push_back(
          {shape.name, solid.link_from_box * Eigen::Translation3d(piece.center()), Box{piece.sizes()}});
  }
  world.links[yielding].collisions = std::move(left);
}

void make_room(const std::string& a, const std::string& b, const std::vector<Front>& fronts, World& world,
               const SemanticMap& semantics) {
  Part yielding = part_of(a, fronts, world, semantics), staying = part_of(b, fronts, world, semantics);
  if (staying.gives_way_to(yielding)) std::swap(yielding, staying);
  for (const size_t link : yielding.links)
    for (const size_t other : staying.links) give_way(link, other, world);
}

}  // namespace

void clear_closed_state(const std::vector<Front>& fronts, World& world, const SemanticMap& semantics) {
  for (const Contact& contact : closed_contacts(world))
    make_room(contact.first, contact.second, fronts, world, semantics);
}

void clear_beginning(const std::string& joint, double min_upper, const std::vector<Front>& fronts,
                     World& world, const SemanticMap& semantics) {
  for (size_t i = 0; i < world.links.size(); ++i) {  // Each time something else is in the way.
    const FreeRange range = free_range(world, *world.find_joint(joint));
    if (range.blocker.empty() || range.upper >= min_upper) return;
    make_room(range.mover, range.blocker, fronts, world, semantics);
  }
}

}  // namespace loci::mapping
