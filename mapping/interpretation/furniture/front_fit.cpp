#include "mapping/interpretation/furniture/front_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "mapping/interpretation/furniture/cabinets.h"
#include "mapping/interpretation/furniture/clearance.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/interpretation/furniture/sliding.h"
#include "mapping/world/contacts.h"
#include "mapping/world/furniture_classes.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

using Bounds = Eigen::AlignedBox3d;

bool is_support(const SemanticMap& semantics, const std::string& link) {
  const auto found = semantics.links.find(link);
  return found != semantics.links.end() && is_support_class(found->second.class_name);
}

bool is_drawer(const Front& front) {
  if (slides_sideways(front)) return false;
  return front.joint ? front.joint->type == ArticulationType::prismatic : front.class_name == "drawer";
}

Bounds panel_box(const FrontBody& body) {
  return {Vector3d(-kFurniture.panel_m, body.panel.min().x(), body.panel.min().y()),
          Vector3d(0, body.panel.max().x(), body.panel.max().y())};
}

/// What a panel passes as it opens.
Bounds before_panel(const FrontBody& body, double reach) {
  Bounds box = panel_box(body);
  box.max().x() = reach;
  return box;
}

/// Around the sides, back and bottom of a drawer.
Bounds drawer_box(const FrontBody& body) {
  Bounds box = panel_box(body);
  box.min().y() = body.drawer.min().x();
  box.max().y() = body.drawer.max().x();
  box.max().x() = -kFurniture.panel_m;
  box.min().x() = box.max().x() - body.drawer_depth;
  return box;
}

/// Around a bar with its posts, or a knob with its neck.
Bounds fixture_box(const Front& front, const FrontBody& body) {
  const Fixture fixture = fitted_fixture(front, body);
  const Isometry3d front_from_map = map_from_front(front).inverse();
  const Vector3d centre = front_from_map * fixture.centre;
  const Vector3d reach =
      (front_from_map.linear() * fixture.axis.normalized() * fixture.length / 2).cwiseAbs() +
      Vector3d::Constant(fixture.radius);
  Bounds box(centre - reach, centre + reach);
  box.min().x() = std::min(box.min().x(), 0.0);
  return box;
}

SolidBox solid_of(const Bounds& box) {
  SolidBox solid;
  solid.link_from_box.translation() = box.center();
  solid.half = box.sizes() / 2;
  return solid;
}

/// A box of one frame along the axes of another.
Bounds moved(const Bounds& box, const Isometry3d& to_from_box) {
  return bounds_of(solid_of(box), to_from_box);
}

Bounds grown(const Bounds& box, double by) {
  return {box.min() - Vector3d::Constant(by), box.max() + Vector3d::Constant(by)};
}

/// Moves the side of a panel that needs it least, so that it keeps the gap to an obstacle in its frame that
/// is less than `before` metres in front of it. Nothing moves by more than `max_way`.
void keep_off(const Bounds& obstacle, double before, const Vector2d& max_way, FrontBody& body) {
  const Bounds wide = grown(obstacle, kFurniture.gap_m);
  if (!wide.intersects(before_panel(body, before))) return;
  if (obstacle.max().x() <= -kFurniture.panel_m || obstacle.min().x() >= before) return;
  const Vector2d low = wide.min().tail<2>(), high = wide.max().tail<2>();
  // How far each side would have to move: those at the low end up, those at the high end down.
  const std::array<double, 4> way = {high.x() - body.panel.min().x(), high.y() - body.panel.min().y(),
                                     body.panel.max().x() - low.x(), body.panel.max().y() - low.y()};
  const auto side = static_cast<int>(std::ranges::min_element(way) - way.begin());
  if (way[static_cast<size_t>(side)] > max_way[side % 2]) return;
  if (side < 2)
    body.panel.min()[side] = high[side];
  else
    body.panel.max()[side - 2] = low[side - 2];
}

/// The part of a flat polygon on one side of a plane across an axis.
std::vector<Vector3d> clipped(const std::vector<Vector3d>& polygon, int axis, double limit, bool below) {
  std::vector<Vector3d> part;
  const auto inside = [&](const Vector3d& corner) {
    return below ? corner[axis] <= limit : corner[axis] >= limit;
  };
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    if (inside(from)) part.push_back(from);
    if (inside(from) != inside(to))
      part.push_back(from + (limit - from[axis]) / (to[axis] - from[axis]) * (to - from));
  }
  return part;
}

/// Around the part of a solid's surface that is in a box; empty = none is.
Bounds part_inside(const Bounds& box, const SolidBox& solid, const Isometry3d& frame_from_link) {
  Bounds part;
  const Isometry3d frame_from_box = frame_from_link * solid.link_from_box;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
    std::vector<Vector3d> face;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      Vector3d corner;
      corner[axis] = (side % 2 == 0 ? -1 : 1) * solid.half[axis];
      corner[a] = x * solid.half[a];
      corner[b] = y * solid.half[b];
      face.push_back(frame_from_box * corner);
    }
    for (int i = 0; i < 3; ++i) face = clipped(clipped(face, i, box.max()[i], true), i, box.min()[i], false);
    for (const Vector3d& corner : face) part.extend(corner);
  }
  return part;
}

/// Shortens a drawer that would reach a solid, or makes it narrower where the solid is beside its front.
void end_before(const SolidBox& solid, const Isometry3d& front_from_link, FrontBody& body) {
  const Bounds part = part_inside(grown(drawer_box(body), kFurniture.gap_m / 2), solid, front_from_link);
  if (part.isEmpty()) return;
  const double depth = -kFurniture.panel_m - part.max().x() - kFurniture.gap_m;
  const double from_low = part.max().y() + kFurniture.gap_m - body.drawer.min().x(),
               from_high = body.drawer.max().x() - part.min().y() + kFurniture.gap_m;
  const double narrower = std::min(from_low, from_high);
  if (depth >= kFurniture.min_drawer_m || narrower > kFurniture.max_cut * body.drawer.sizes().x())
    body.drawer_depth = std::min(body.drawer_depth, std::max(depth, kFurniture.min_drawer_m));
  else if (from_low < from_high)
    body.drawer.min().x() += from_low;
  else
    body.drawer.max().x() -= from_high;
}

FrontBody measured_body(const Front& front) {
  const Vector2d half(front.width / 2, front.height / 2);
  const Vector2d inset = Vector2d::Constant(kFurniture.gap_m / 2).cwiseMin(0.2 * half);
  FrontBody body;
  body.panel = Eigen::AlignedBox2d(inset - half, half - inset);
  body.drawer_depth = std::max(front.depth - kFurniture.panel_m, kFurniture.min_drawer_m);
  return body;
}

/// The boxes of a support's slab in its link, whose top is z = 0; none where they stand askew or are round:
/// such slabs are not cut.
std::vector<Bounds> slab_of(const Link& link) {
  std::vector<Bounds> slab;
  for (const Collision& shape : link.collisions) {
    const Box* box = std::get_if<Box>(&shape.geometry);
    if (box == nullptr || !shape.link_from_collision.linear().isIdentity(1e-9)) return {};
    const Vector3d middle = shape.link_from_collision.translation();
    slab.emplace_back(middle - box->size / 2, middle + box->size / 2);
  }
  return slab;
}

/// Whether a link is a slab that gives way to fronts (cut_supports()).
bool is_slab(const SemanticMap& semantics, const Link& link) {
  return is_support(semantics, link.name) && !is_inferred_cabinet(semantics.links.at(link.name)) &&
         !slab_of(link).empty();
}

/// Lowers the upper edge of a panel that was found in the top of a slab over it, or hardly above: what is
/// below a counter ends below it, and leaves it a thickness.
void end_below(const std::vector<Bounds>& slab, const Isometry3d& slab_from_front, const Front& front,
               FrontBody& body) {
  // Where the edges lie farther apart the front goes on before the slab, which gives way.
  if (moved(panel_box(body), slab_from_front).max().z() > kCabinets.aligned_m) return;
  Bounds solid = panel_box(body);
  if (is_drawer(front)) solid.min().x() -= body.drawer_depth;
  solid = moved(solid, slab_from_front);
  const bool touches = std::ranges::any_of(
      slab, [&](const Bounds& part) { return grown(part, kFurniture.gap_m).intersects(solid); });
  const double too_high = solid.max().z() + kFurniture.min_slab_m + 2 * kFurniture.gap_m;  // above and below
  if (touches && too_high > 0 && too_high < kFurniture.max_cut * body.panel.sizes().y())
    body.panel.max().y() -= too_high;
}

/// Cuts the solids of fronts, given in the slab's frame, out of the slab.
std::vector<Bounds> cut_slab(std::vector<Bounds> slab, const std::vector<Bounds>& solids) {
  double underside = 0;
  for (const Bounds& part : slab) underside = std::min(underside, part.min().z());
  for (const Bounds& solid : solids) {
    const double free = solid.max().z() + kFurniture.gap_m;
    const bool below = std::ranges::any_of(
        slab, [&](const Bounds& part) { return grown(part, kFurniture.gap_m / 2).intersects(solid); });
    if (below && free <= -kFurniture.min_slab_m) underside = std::max(underside, free);
  }
  for (Bounds& part : slab) part.min().z() = underside;
  for (const Bounds& solid : solids) {
    std::vector<Bounds> rest;
    for (const Bounds& part : slab) cut_out(grown(solid, kFurniture.gap_m), part, rest);
    slab = std::move(rest);
  }
  return slab;
}

}  // namespace

void cut_out(const Bounds& cut, const Bounds& from, std::vector<Bounds>& rest) {
  if (!cut.intersects(from)) {
    rest.push_back(from);
    return;
  }
  Bounds left = from;
  for (int axis = 2; axis >= 0; --axis) {
    Bounds below = left, above = left;
    below.max()[axis] = std::min(cut.min()[axis], left.max()[axis]);
    above.min()[axis] = std::max(cut.max()[axis], left.min()[axis]);
    for (const Bounds& part : {below, above})
      if ((part.sizes().array() > kFurniture.min_rest_m).all()) rest.push_back(part);
    left.min()[axis] = std::max(left.min()[axis], cut.min()[axis]);
    left.max()[axis] = std::min(left.max()[axis], cut.max()[axis]);
  }
}

Isometry3d map_from_front(const Front& front) {
  Isometry3d pose = Isometry3d::Identity();
  const Vector3d x = front.normal.normalized();
  const Vector3d y = front.up.cross(x).normalized();
  pose.linear() << x, y, x.cross(y);
  pose.translation() = front.centre;
  return pose;
}

Vector3d fitted_hinge(const Front& front, const FrontBody& body) {
  const Isometry3d map_from = map_from_front(front);
  const Vector3d axis = map_from.linear().transpose() * front.joint->axis;
  Vector3d hinge = map_from.inverse() * front.joint->origin;
  const int across = std::abs(axis.z()) > std::abs(axis.y()) ? 1 : 2;  // of the panel, square to the axis
  double& at = hinge[across];
  const double edge = at < 0 ? body.panel.min()[across - 1] : body.panel.max()[across - 1];
  const double beside = std::abs(at - edge), behind = std::abs(hinge.x());
  const bool fits = beside <= kFurniture.gap_m && behind <= kFurniture.max_hinge_behind_m;
  if (fits || beside > kFurniture.hinge_m || behind > kFurniture.hinge_m || std::abs(axis.x()) > 0.1)
    return front.joint->origin;
  at = edge;
  hinge.x() = 0;
  return map_from * hinge;
}

Fixture fitted_fixture(const Front& front, const FrontBody& body) {
  Fixture fixture = *front.fixture;
  const Isometry3d map_from = map_from_front(front);
  const Vector2d axis = (map_from.linear().transpose() * fixture.axis.normalized()).tail<2>();
  const Vector2d room = body.panel.sizes() / 2 - Vector2d::Constant(fixture.radius);
  for (int i = 0; i < 2; ++i)
    if (std::abs(axis[i]) * fixture.length / 2 > room[i])
      fixture.length = std::max(0.0, 2 * room[i] / std::abs(axis[i]));
  const Vector2d reach = axis.cwiseAbs() * fixture.length / 2;
  const Vector2d play = (room - reach).cwiseMax(0);
  Vector3d centre = map_from.inverse() * fixture.centre;
  const Vector2d middle = body.panel.center();
  centre.tail<2>() = centre.tail<2>().cwiseMax(middle - play).cwiseMin(middle + play);
  fixture.centre = map_from * centre;
  return fixture;
}

std::vector<FrontBody> fit_fronts(const std::vector<Front>& fronts, const World& world,
                                  const SemanticMap& semantics) {
  std::vector<FrontBody> bodies;
  std::vector<Isometry3d> map_from;
  for (const Front& front : fronts) {
    bodies.push_back(measured_body(front));
    map_from.push_back(map_from_front(front));
  }
  std::vector<size_t> order(fronts.size());
  std::iota(order.begin(), order.end(), 0);
  // Those that were moved are where their motion showed them.
  const auto certainty = [&](size_t i) {
    return std::pair(fronts[i].joint && fronts[i].joint->evidence != "prior", fronts[i].confidence);
  };
  std::ranges::stable_sort(order, [&](size_t a, size_t b) { return certainty(a) > certainty(b); });

  const std::vector<Isometry3d> map_from_link = root_from_links(world, {});
  std::vector<SolidBox> standing = solid_boxes(world);
  std::erase_if(standing, [&](const SolidBox& box) {
    const Link& link = world.links[box.link];
    return is_slab(semantics, link) ||
           (is_support(semantics, link.name) && is_inferred_cabinet(semantics.links.at(link.name)));
  });
  const auto seen_from = [&](size_t i, const SolidBox& box) {
    return bounds_of(box, map_from[i].inverse() * map_from_link[box.link]);
  };
  for (size_t l = 0; l < world.links.size(); ++l)
    for (size_t i = 0; i < fronts.size() && is_slab(semantics, world.links[l]); ++i)
      end_below(slab_of(world.links[l]), map_from_link[l].inverse() * map_from[i], fronts[i], bodies[i]);
  for (size_t k = 0; k < order.size(); ++k) {
    const size_t i = order[k];
    const Vector2d most = kFurniture.max_cut * bodies[i].panel.sizes();
    for (const SolidBox& box : standing) keep_off(seen_from(i, box), 0, most, bodies[i]);
    for (size_t m = 0; m < k; ++m)
      keep_off(moved(panel_box(bodies[order[m]]), map_from[i].inverse() * map_from[order[m]]), 0, most,
               bodies[i]);
  }
  // Opening, a panel slides past what stands beside its face.
  const Vector2d little = Vector2d::Constant(kFurniture.max_planing_m);
  for (size_t i = 0; i < fronts.size(); ++i) {
    if (!fronts[i].joint || fronts[i].joint->type == ArticulationType::rigid) continue;
    const double reach = is_drawer(fronts[i]) ? fronts[i].depth : fronts[i].width;
    for (const SolidBox& box : standing) keep_off(seen_from(i, box), reach, little, bodies[i]);
    for (size_t m = 0; m < fronts.size(); ++m)
      if (m != i)
        keep_off(moved(panel_box(bodies[m]), map_from[i].inverse() * map_from[m]), reach, little, bodies[i]);
  }
  for (size_t k = 0; k < order.size(); ++k) {
    const size_t i = order[k];
    if (!is_drawer(fronts[i])) continue;
    FrontBody& body = bodies[i];
    body.drawer = Eigen::AlignedBox1d(body.panel.min().head<1>(), body.panel.max().head<1>());
    const Isometry3d here_from_map = map_from[i].inverse();
    for (const SolidBox& box : standing) end_before(box, here_from_map * map_from_link[box.link], body);
    for (size_t m = 0; m < fronts.size(); ++m) {
      const size_t other = order[m];
      if (other == i) continue;
      const Isometry3d here_from_there = here_from_map * map_from[other];
      end_before(solid_of(panel_box(bodies[other])), here_from_there, body);
      if (m < k && is_drawer(fronts[other]))
        end_before(solid_of(drawer_box(bodies[other])), here_from_there, body);
      if (fronts[other].fixture)
        end_before(solid_of(fixture_box(fronts[other], bodies[other])), here_from_there, body);
    }
  }
  return bodies;
}

void cut_supports(const std::vector<Front>& fronts, const std::vector<FrontBody>& bodies, World& world,
                  const SemanticMap& semantics) {
  const std::vector<Isometry3d> map_from_link = root_from_links(world, {});
  for (size_t l = 0; l < world.links.size(); ++l) {
    Link& link = world.links[l];
    if (!is_slab(semantics, link)) continue;
    std::vector<Bounds> solids;
    for (size_t i = 0; i < fronts.size(); ++i) {
      const Isometry3d link_from_front = map_from_link[l].inverse() * map_from_front(fronts[i]);
      solids.push_back(moved(panel_box(bodies[i]), link_from_front));
      if (is_drawer(fronts[i])) solids.push_back(moved(drawer_box(bodies[i]), link_from_front));
      if (fronts[i].fixture) solids.push_back(moved(fixture_box(fronts[i], bodies[i]), link_from_front));
    }
    std::vector<LinkPart> parts;
    for (const Bounds& part : cut_slab(slab_of(link), solids))
      parts.push_back(box_part(part.center(), part.sizes()));
    if (parts.empty())
      link.collisions.clear();  // It was seen, but what is solid here are the fronts.
    else
      set_parts(link, semantics.links.at(link.name).class_name, parts);
  }
}

void limit_joints(const std::vector<Front>& fronts, World& world, SemanticMap& semantics) {
  for (const Front& front : fronts) {
    const std::optional<std::string> link = front_link(front.name, semantics);
    if (!link) continue;
    const auto joint =
        std::ranges::find_if(world.joints, [&](const Joint& one) { return one.child == *link; });
    if (joint == world.joints.end() || joint->type == JointType::fixed || !joint->limits) continue;
    clear_beginning(joint->name,
                    joint->type == JointType::prismatic ? kFurniture.min_slide_m : kFurniture.min_turn,
                    fronts, world, semantics);
    const FreeRange range = free_range(world, *joint);
    if (range.blocker.empty()) continue;
    joint->limits->upper = range.upper;
    semantics.links[*link].extra["blocked_by"] = range.blocker;
  }
}

}  // namespace loci::mapping
