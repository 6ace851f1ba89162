#include "mapping/simulation/kitchen_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace loci::mapping::kitchen {
namespace {

const Rgba kSteel(0.66F, 0.67F, 0.7F, 1), kInside(0.8F, 0.77F, 0.7F, 1);
constexpr double kBoard_m = 0.012;
/// Between a cabinet and the board of its front.
constexpr double kBuffer_m = 0.002;

Isometry3d at(const Vector3d& position) {
  return Isometry3d(Eigen::Translation3d(position));
}

/// To a tenth of a millimetre, which is finer than any furniture.
double rounded(double value) {
  return std::round(value * 1e4) / 1e4 + 0.0;
}

Json json_of(const Vector3d& v) {
  return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

bool is_hinged_beside(Opening opening) {
  return opening == Opening::hinged_left || opening == Opening::hinged_right;
}

std::string kind_of(Opening opening) {
  if (opening == Opening::fixed) return "front";
  if (opening == Opening::drawer) return "drawer";
  return is_hinged_beside(opening) ? "door" : "flap";
}

/// From the centre of a front's face to its joint.
Vector3d hinge_offset(Opening opening, const Vector2d& size) {
  switch (opening) {
    case Opening::hinged_left:
      return {0, -size.x() / 2, 0};
    case Opening::hinged_right:
      return {0, size.x() / 2, 0};
    case Opening::hinged_top:
      return {0, 0, size.y() / 2};
    case Opening::hinged_bottom:
      return {0, 0, -size.y() / 2};
    default:
      return Vector3d::Zero();
  }
}

/// Opens along or about its positive direction.
Vector3d axis_of(Opening opening) {
  switch (opening) {
    case Opening::hinged_left:
      return -Vector3d::UnitZ();
    case Opening::hinged_right:
      return Vector3d::UnitZ();
    case Opening::hinged_top:
      return -Vector3d::UnitY();
    case Opening::hinged_bottom:
      return Vector3d::UnitY();
    default:
      return Vector3d::UnitX();
  }
}

}  // namespace

Builder::Builder(const std::string& name, const Isometry3d& map_from_room) {
  kitchen_.world.name = name;
  kitchen_.world.root = "map";
  kitchen_.world.links.push_back({"map", {}, {}, {}});
  map_from_link_["map"] = Isometry3d::Identity();
  link("room", "map", map_from_room);
}

std::string Builder::link(const std::string& kind, const std::string& parent,
                          const Isometry3d& parent_from_link) {
  const int number = ++counts_[kind];
  const std::string name = kind == "room" || kind == "floor" ? kind : fmt::format("{}_{}", kind, number);
  add_link(name, parent, parent_from_link);
  return name;
}

void Builder::add_link(const std::string& name, const std::string& parent,
                       const Isometry3d& parent_from_link) {
  kitchen_.world.links.push_back({name, {}, {}, {}});
  Joint joint;
  joint.name = name + "_joint";
  joint.parent = parent;
  joint.child = name;
  joint.parent_from_joint = parent_from_link;
  kitchen_.world.joints.push_back(joint);
  map_from_link_[name] = map_from_link_.at(parent) * parent_from_link;
}

void Builder::add_shape(const std::string& link, const Isometry3d& link_from_shape, const Geometry& shape,
                        const Rgba& color) {
  Link& to = kitchen_.world.links[kitchen_.world.link_index(link)];
  const auto byte = [&](int channel) { return static_cast<int>(std::lround(color[channel] * 255)); };
  const Material material{fmt::format("color_{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2)),
                          Rgba(static_cast<float>(byte(0)) / 255, static_cast<float>(byte(1)) / 255,
                               static_cast<float>(byte(2)) / 255, 1),
                          ""};
  to.visuals.push_back({"", link_from_shape, shape, material});
  to.collisions.push_back({"", link_from_shape, shape});
}

void Builder::box(const std::string& link, const Vector3d& low, const Vector3d& high, const Rgba& color) {
  add_shape(link, at((low + high) / 2), Box{high - low}, color);
}

void Builder::rod(const std::string& link, const Vector3d& from, const Vector3d& to, double radius,
                  const Rgba& color) {
  Isometry3d link_from_rod = at((from + to) / 2);
  link_from_rod.linear() = rotation_between(Vector3d::UnitZ(), to - from);
  add_shape(link, link_from_rod, Cylinder{radius, (to - from).norm()}, color);
}

void Builder::ball(const std::string& link, const Vector3d& centre, double radius, const Rgba& color) {
  add_shape(link, at(centre), Sphere{radius}, color);
}

void Builder::front(const std::string& cabinet, const FrontCell& cell, Opening opening, Grip grip_kind,
                    GripHeight grip_height, const FrontStyle& style, double depth) {
  const double half_seam = style.seam / 2, face_x = kBuffer_m + style.thickness;
  const Vector2d size(cell.right - cell.left - style.seam, cell.top - cell.bottom - style.seam);
  const Vector3d face(face_x, (cell.left + cell.right) / 2, (cell.bottom + cell.top) / 2);
  const Vector3d joint_at = face + hinge_offset(opening, size), centre = face - joint_at;
  const std::string name = link(kind_of(opening), cabinet, at(joint_at));
  box(name, centre + Vector3d(-style.thickness, -size.x() / 2, -size.y() / 2),
      centre + Vector3d(0, size.x() / 2, size.y() / 2), style.color);
  Joint& joint = kitchen_.world.joints.back();
  if (opening != Opening::fixed) {
    joint.type = opening == Opening::drawer ? JointType::prismatic : JointType::revolute;
    joint.axis = axis_of(opening);
    const double open = opening == Opening::drawer ? rounded(0.8 * depth - half_seam) : 1.5;
    joint.limits = JointLimits{0, open, 60, 1};
  }
  if (opening == Opening::drawer) drawer_box(name, size, depth, style.thickness);
  const Eigen::Matrix3d turn = map_from_link_.at(name).linear();
  SemanticLink& said = describe(name, kind_of(opening),
                                {{"centre", json_of(in_map(name, centre))},
                                 {"normal", json_of(turn.col(0))},
                                 {"up", json_of(turn.col(2))},
                                 {"width", rounded(size.x())},
                                 {"height", rounded(size.y())},
                                 {"depth", rounded(depth)}});
  if (opening != Opening::fixed) said.extra["joint_evidence"] = "prior";
  if (grip_kind != Grip::none) grip(name, centre, size, opening, grip_kind, grip_height, style);
}

void Builder::drawer_box(const std::string& drawer, const Vector2d& size, double depth, double thickness) {
  const double back = -thickness - (depth - 0.06), front = -thickness, half = size.x() / 2 - 0.03;
  const double floor = -size.y() / 2 + 0.03 + kBoard_m,  // top of the bottom
      rim = std::min(floor - kBoard_m + std::min(0.6 * size.y(), 0.2), size.y() / 2 - 0.02);
  box(drawer, {back, -half, floor}, {front, -half + kBoard_m, rim}, kInside);
  box(drawer, {back, half - kBoard_m, floor}, {front, half, rim}, kInside);
  box(drawer, {back, -half + kBoard_m, floor}, {back + kBoard_m, half - kBoard_m, rim}, kInside);
  const std::string bottom = drawer + "_bottom";
  const double reach = (front - back) / 2;
  add_link(bottom, drawer, at({(back + front) / 2, 0, floor}));
  box(bottom, {-reach, -half, -kBoard_m}, {reach, half, 0}, kInside);
  const Vector2d inside(reach - kBoard_m, half - kBoard_m);  // between the sides; the back has one board
  describe_support(
      bottom, "drawer_bottom",
      {{-inside.x(), -inside.y()}, {reach, -inside.y()}, {reach, inside.y()}, {-inside.x(), inside.y()}}, 0);
}

void Builder::grip(const std::string& front, const Vector3d& face, const Vector2d& size, Opening opening,
                   Grip kind, GripHeight height, const FrontStyle& style) {
  const bool upright = is_hinged_beside(opening) && kind != Grip::rail;
  double length = kind == Grip::knob ? 2 * style.knob_radius : style.bar_length;
  if (kind == Grip::rail) length = size.x() - 0.06;
  length = std::min(length, (upright ? size.y() : size.x()) - 0.06);
  Vector3d foot = face;
  if (is_hinged_beside(opening)) {
    foot.y() += (size.x() / 2 - style.edge) * (opening == Opening::hinged_left ? 1 : -1);
    const double reach = size.y() / 2 - length / 2 - style.edge;
    if (height != GripHeight::middle) foot.z() += height == GripHeight::high ? reach : -reach;
    if (kind == Grip::rail) {
      foot.y() = face.y();
      foot.z() = face.z() + (height == GripHeight::low ? -1 : 1) * (size.y() / 2 - 0.03);
    }
  } else if (size.y() > 0.24 || kind == Grip::rail) {  // the middle of low drawers
    foot.z() +=
        (size.y() / 2 - (kind == Grip::rail ? 0.03 : style.edge)) * (opening == Opening::hinged_top ? -1 : 1);
  }
  if (kind == Grip::knob)
    knob(front, foot, style);
  else
    bar(front, foot, upright ? Vector3d::UnitZ() : Vector3d::UnitY(), length, style);
}

void Builder::bar(const std::string& front, const Vector3d& foot, const Vector3d& along, double length,
                  const FrontStyle& style) {
  const std::string name = link("handle", front, at(foot));
  const Vector3d axis(style.bar_distance, 0, 0), half = along * (length / 2);
  rod(name, axis - half, axis + half, style.bar_radius, kSteel);
  for (const double side : {-0.85, 0.85})
    rod(name, side * half, side * half + axis, 0.7 * style.bar_radius, kSteel);
  describe(name, "handle",
           {{"centre", json_of(in_map(name, axis))},
            {"axis", json_of(map_from_link_.at(name).linear() * along)},
            {"length", rounded(length)}});
}

void Builder::knob(const std::string& front, const Vector3d& foot, const FrontStyle& style) {
  const std::string name = link("knob", front, at(foot));
  constexpr double kStem = 0.012;
  const double radius = style.knob_radius, deep = style.knob_is_ball ? 2 * radius : 1.2 * radius;
  rod(name, Vector3d::Zero(), {kStem + 0.002, 0, 0}, 0.006, kSteel);
  const Vector3d head(kStem + deep / 2, 0, 0);
  if (style.knob_is_ball)
    ball(name, head, radius, kSteel);
  else
    rod(name, {kStem, 0, 0}, {kStem + deep, 0, 0}, radius, kSteel);
  describe(name, "knob",
           {{"centre", json_of(in_map(name, head))},
            {"axis", json_of(map_from_link_.at(name).linear().col(0))},
            {"length", rounded(2 * radius)}});
}

SemanticLink& Builder::describe(const std::string& link, const std::string& class_name,
                                const Json& geometry) {
  SemanticLink& said = kitchen_.semantics.links[link];
  said.class_name = class_name;
  said.confidence = 1;
  said.geometry = geometry;
  said.evidence = {{"source", "drawn"}};
  return said;
}

void Builder::describe_floor(const std::string& link, const std::vector<Vector2d>& outline) {
  describe_support(link, "floor", outline, 0);
}

void Builder::describe_support(const std::string& link, const std::string& class_name,
                               const std::vector<Vector2d>& outline, double height) {
  Json corners = Json::array();
  for (const Vector2d& corner : outline) {
    const Vector3d point = in_map(link, {corner.x(), corner.y(), height});
    corners.push_back({rounded(point.x()), rounded(point.y())});
  }
  describe(link, class_name, {{"height", rounded(in_map(link, {0, 0, height}).z())}, {"outline", corners}});
}

void Builder::describe_wall(const std::string& link, const Vector3d& normal,
                            const std::vector<Vector3d>& corners, const Json& openings) {
  Json outline = Json::array();
  for (const Vector3d& corner : corners) outline.push_back(json_of(in_map(link, corner)));
  const Vector3d turned = map_from_link_.at(link).linear() * normal;
  describe(link, "wall",
           {{"normal", json_of(turned)},
            {"offset", rounded(turned.dot(in_map(link, corners.front())))},
            {"outline", outline},
            {"openings", openings}});
}

Vector3d Builder::in_map(const std::string& link, const Vector3d& point) const {
  return map_from_link_.at(link) * point;
}

}  // namespace loci::mapping::kitchen
