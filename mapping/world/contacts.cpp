#include "mapping/world/contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

constexpr double kSlideStep_m = 0.005;
constexpr double kTurnStep = kDegree;
constexpr double kParallel = 1e-6;  ///< of an edge direction's length, below which it gives no new axis

struct PlacedBox {
  Isometry3d pose;
  Vector3d half;
  Vector3d reach;  ///< half sizes of the box around it along the root's axes
};

PlacedBox placed(const SolidBox& box, const Isometry3d& root_from_link) {
  const Isometry3d pose = root_from_link * box.link_from_box;
  return {pose, box.half, pose.linear().cwiseAbs() * box.half};
}

/// Penetration depth of two boxes by the separating axis theorem; 0 or less where they are apart.
double penetration(const PlacedBox& a, const PlacedBox& b) {
  const Vector3d apart = b.pose.translation() - a.pose.translation();
  if (((apart.cwiseAbs() - a.reach - b.reach).array() >= 0).any()) return 0;
  double depth = std::numeric_limits<double>::max();
  const auto along = [&](const Vector3d& axis) {
    const double overlap = (a.pose.linear().transpose() * axis).cwiseAbs().dot(a.half) +
                           (b.pose.linear().transpose() * axis).cwiseAbs().dot(b.half) -
                           std::abs(apart.dot(axis));
    depth = std::min(depth, overlap);
    return overlap > 0;
  };
  for (int i = 0; i < 3; ++i)
    if (!along(a.pose.linear().col(i)) || !along(b.pose.linear().col(i))) return depth;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vector3d axis = a.pose.linear().col(i).cross(b.pose.linear().col(j));
      if (axis.norm() > kParallel && !along(axis.normalized())) return depth;
    }
  return depth;
}

Vector3d half_size(const Geometry& geometry) {
  if (const auto* box = std::get_if<Box>(&geometry)) return box->size / 2;
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return {cylinder->radius, cylinder->radius, cylinder->length / 2};
  return Vector3d::Constant(std::get<Sphere>(geometry).radius);
}

/// By link: the link below the nearest joint that moves; the root where there is none.
std::vector<size_t> bodies_of(const World& world) {
  std::vector<size_t> bodies;
  for (const Link& link : world.links) {
    const Joint* joint = moving_joint(world, link.name);
    bodies.push_back(world.link_index(joint == nullptr ? world.root : joint->child));
  }
  return bodies;
}

}  // namespace

std::vector<SolidBox> solid_boxes(const World& world) {
  std::vector<SolidBox> boxes;
  for (size_t i = 0; i < world.links.size(); ++i)
    for (const Collision& shape : world.links[i].collisions)
      if (!std::holds_alternative<Mesh>(shape.geometry))
        boxes.push_back({i, shape.link_from_collision, half_size(shape.geometry)});
  return boxes;
}

Eigen::AlignedBox3d bounds_of(const SolidBox& box, const Isometry3d& frame_from_link) {
  const PlacedBox seen = placed(box, frame_from_link);
  return {seen.pose.translation() - seen.reach, seen.pose.translation() + seen.reach};
}

std::vector<Contact> closed_contacts(const World& world) {
  const std::vector<SolidBox> boxes = solid_boxes(world);
  const std::vector<Isometry3d> root_from_link = root_from_links(world, {});
  const std::vector<size_t> bodies = bodies_of(world);
  const size_t still = world.link_index(world.root);
  const auto hangs_on = [&](size_t body, size_t other) {
    const Joint* joint = world.parent_joint(world.links[body].name);
    return joint != nullptr && other != still && bodies[world.link_index(joint->parent)] == other;
  };
  std::vector<PlacedBox> shapes;
  for (const SolidBox& box : boxes) shapes.push_back(placed(box, root_from_link[box.link]));
  std::map<std::pair<size_t, size_t>, double> depths;
  for (size_t i = 0; i < shapes.size(); ++i) {
    const size_t body = bodies[boxes[i].link];
    if (body == still) continue;
    for (size_t j = 0; j < shapes.size(); ++j) {
      const size_t other = bodies[boxes[j].link];
      if (other == body || (other != still && j <= i) || hangs_on(body, other) || hangs_on(other, body))
        continue;
      const double depth = penetration(shapes[i], shapes[j]);
      if (depth <= 0) continue;
      double& deepest = depths[{boxes[i].link, boxes[j].link}];
      deepest = std::max(deepest, depth);
    }
  }
  std::vector<Contact> contacts;
  for (const auto& [links, depth] : depths)
    contacts.push_back({world.links[links.first].name, world.links[links.second].name, depth});
  std::ranges::stable_sort(contacts, [](const Contact& a, const Contact& b) { return a.depth > b.depth; });
  return contacts;
}

FreeRange free_range(const World& world, const Joint& joint) {
  if (!joint.limits) throw Error("the joint '" + joint.name + "' has no limits");
  const std::vector<SolidBox> boxes = solid_boxes(world);
  const std::vector<Isometry3d> closed = root_from_links(world, {});
  const double upper = joint.limits->upper;
  const double step = joint.type == JointType::prismatic ? kSlideStep_m : kTurnStep;
  std::vector<size_t> moving, standing;
  const std::vector<Isometry3d> open = root_from_links(world, {{joint.name, upper}});
  for (size_t i = 0; i < boxes.size(); ++i)
    (open[boxes[i].link].isApprox(closed[boxes[i].link]) ? standing : moving).push_back(i);
  std::vector<PlacedBox> obstacles;
  for (const size_t i : standing) obstacles.push_back(placed(boxes[i], closed[boxes[i].link]));
  const std::vector<size_t> bodies = bodies_of(world);
  const size_t still = world.link_index(world.root);
  const auto obstacle_of = [&](size_t link) { return bodies[link] == still ? link : bodies[link]; };
  std::set<size_t> ignored;
  const int steps = std::max(1, static_cast<int>(std::ceil(upper / step)));
  for (int k = 0; k <= steps; ++k) {
    const std::vector<Isometry3d> now = root_from_links(world, {{joint.name, upper * k / steps}});
    for (const size_t i : moving) {
      const PlacedBox shape = placed(boxes[i], now[boxes[i].link]);
      for (size_t j = 0; j < obstacles.size(); ++j) {
        if (penetration(shape, obstacles[j]) <= 0) continue;
        const size_t obstacle = obstacle_of(boxes[standing[j]].link);
        if (k == 0)
          ignored.insert(obstacle);
        else if (!ignored.contains(obstacle))
          return {upper * (k - 1) / steps, world.links[boxes[standing[j]].link].name,
                  world.links[boxes[i].link].name};
      }
    }
  }
  return {upper, {}, {}};
}

}  // namespace loci::mapping
