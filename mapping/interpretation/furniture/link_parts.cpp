#include "mapping/interpretation/furniture/link_parts.h"

#include <array>
#include <utility>

#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"

namespace loci::mapping {
namespace {

double volume_of(const Geometry& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return box->size.prod();
  const auto& rod = std::get<Cylinder>(shape);
  return kPi * rod.radius * rod.radius * rod.length;
}

/// Inertia over mass about the part's centre, in its axes.
Vector3d gyration_of(const Geometry& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vector3d squares = box->size.cwiseProduct(box->size);
    return (squares.sum() - squares.array()) / 12;
  }
  const auto& rod = std::get<Cylinder>(shape);
  const double across = (3 * rod.radius * rod.radius + rod.length * rod.length) / 12;
  return {across, across, rod.radius * rod.radius / 2};
}

}  // namespace

LinkPart box_part(const Vector3d& centre, const Vector3d& size) {
  LinkPart part{Box{size}};
  part.link_from_part.translation() = centre;
  return part;
}

LinkPart rod_part(const Vector3d& from, const Vector3d& to, double radius, double density) {
  LinkPart part{Cylinder{radius, (to - from).norm()}};
  part.density = density;
  part.link_from_part.translation() = (from + to) / 2;
  part.link_from_part.linear() = rotation_between(Vector3d::UnitZ(), to - from);
  return part;
}

Inertial inertial_of(const std::vector<LinkPart>& parts) {
  Inertial inertial;
  Vector3d weighted = Vector3d::Zero();
  for (const LinkPart& part : parts) {
    const double mass = part.density * volume_of(part.shape);
    inertial.mass += mass;
    weighted += mass * part.link_from_part.translation();
  }
  const Vector3d centre = weighted / inertial.mass;
  inertial.link_from_inertial.translation() = centre;
  for (const LinkPart& part : parts) {
    const double mass = part.density * volume_of(part.shape);
    const Eigen::Matrix3d turn = part.link_from_part.linear();
    const Vector3d offset = part.link_from_part.translation() - centre;
    inertial.inertia +=
        mass * (turn * gyration_of(part.shape).asDiagonal() * turn.transpose() +
                offset.squaredNorm() * Eigen::Matrix3d::Identity() - offset * offset.transpose());
  }
  return inertial;
}

Rgba color_of(const std::string& class_name) {
  static const std::array<std::pair<const char*, Rgba>, 14> kColors = {{
      {"floor", {0.75F, 0.72F, 0.68F, 1}},
      {"ceiling", {0.95F, 0.95F, 0.95F, 1}},
      {"wall", {0.88F, 0.87F, 0.84F, 1}},
      {"table", {0.72F, 0.52F, 0.32F, 1}},
      {"counter", {0.45F, 0.48F, 0.52F, 1}},
      {"island", {0.45F, 0.48F, 0.52F, 1}},
      {"front", {0.66F, 0.74F, 0.80F, 1}},
      {"drawer", {0.55F, 0.67F, 0.78F, 1}},
      {"door", {0.58F, 0.71F, 0.68F, 1}},
      {"flap", {0.67F, 0.66F, 0.79F, 1}},
      {"handle", {0.36F, 0.38F, 0.40F, 1}},
      {"knob", {0.36F, 0.38F, 0.40F, 1}},
      {"drawer_bottom", {0.80F, 0.70F, 0.54F, 1}},
      {"drawer_side", {0.80F, 0.70F, 0.54F, 1}},
  }};
  for (const auto& [name, color] : kColors)
    if (name == class_name) return color;
  return {0.62F, 0.45F, 0.35F, 1};
}

void set_parts(Link& link, const std::string& class_name, const std::vector<LinkPart>& parts) {
  link.visuals.clear();
  link.collisions.clear();
  link.inertial.reset();
  for (const LinkPart& part : parts) {
    link.visuals.push_back(
        {"", part.link_from_part, part.shape, Material{class_name, color_of(class_name), ""}});
    link.collisions.push_back({"", part.link_from_part, part.shape});
  }
  if (!parts.empty()) link.inertial = inertial_of(parts);
}

Joint& add_link(World& world, const std::string& name, const std::string& class_name,
                const std::string& parent, const Isometry3d& parent_from_link,
                const std::vector<LinkPart>& parts) {
  Link link;
  link.name = name;
  set_parts(link, class_name, parts);
  world.links.push_back(std::move(link));
  Joint joint;
  joint.name = name + "_joint";
  joint.parent = parent;
  joint.child = name;
  joint.parent_from_joint = parent_from_link;
  world.joints.push_back(std::move(joint));
  return world.joints.back();
}

}  // namespace loci::mapping
