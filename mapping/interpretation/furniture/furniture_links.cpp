#include "mapping/interpretation/furniture/furniture_links.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/clearance.h"
#include "mapping/interpretation/furniture/front_fit.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/interpretation/furniture/sliding.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

constexpr std::array<ArticulationType, 3> kTypes = {ArticulationType::rigid, ArticulationType::prismatic,
                                                    ArticulationType::revolute};

Isometry3d at(double x, double y, double z) {
  return Isometry3d(Eigen::Translation3d(x, y, z));
}

constexpr double kStandardGravity = 9.80665;

/// Writes one front. The frame of most of its links is the front's: x outward, y to the right of a person in
/// front of it, z up.
class FrontWriter {
 public:
  FrontWriter(const Front& front, const FrontBody& body, const std::string& parent, World& world,
              SemanticMap& semantics)
      : front_(front),
        body_(body),
        world_(world),
        semantics_(semantics),
        parent_(parent),
        map_from_parent_(root_from_links(world, {})[world.link_index(parent)]),
        map_from_front_(map_from_front(front)) {}

  void write() {
    if (slides_sideways(front_))
      write_sliding();
    else if (front_.joint ? front_.joint->type == ArticulationType::prismatic : front_.class_name == "drawer")
      write_drawer();
    else if (front_.joint && front_.joint->type == ArticulationType::revolute)
      write_hinged();
    else
      write_panel(front_.name, parent_, map_from_parent_.inverse() * map_from_front_, at(0, 0, 0));
  }

 private:
  LinkPart panel() const {
    const Vector2d middle = body_.panel.center(), size = body_.panel.sizes();
    return box_part({-kFurniture.panel_m / 2, middle.x(), middle.y()},
                    {kFurniture.panel_m, size.x(), size.y()});
  }

  Joint& write_panel(const std::string& name, const std::string& parent, const Isometry3d& parent_from_link,
                     const Isometry3d& link_from_front) {
    LinkPart part = panel();
    part.link_from_part = link_from_front * part.link_from_part;
    const size_t joint = world_.joints.size();
    add_link(world_, name, front_.class_name, parent, parent_from_link, {part});
    describe_front(name);
    std::string handle_parent = name;
    if (!link_from_front.isApprox(Isometry3d::Identity())) {
      handle_parent = front_.name + "_front";
      add_link(world_, handle_parent, front_.class_name, name, link_from_front, {});
    }
    if (front_.fixture) write_fixture(*front_.fixture, handle_parent);
    return world_.joints[joint];
  }

  /// A panel that slides along its plane.
  void write_sliding() {
    Joint& joint =
        write_panel(front_.name, parent_, map_from_parent_.inverse() * map_from_front_, at(0, 0, 0));
    joint.type = JointType::prismatic;
    joint.axis = map_from_front_.linear().transpose() * front_.joint->axis;
    limit(joint, front_.width, 60, 0.5);
  }

  void write_drawer() {
    const std::string front = front_.name + "_front";
    Joint& joint = write_panel(front, parent_, map_from_parent_.inverse() * map_from_front_, at(0, 0, 0));
    const double depth = body_.drawer_depth;
    if (front_.joint && front_.joint->type == ArticulationType::prismatic) {
      joint.type = JointType::prismatic;
      joint.axis = map_from_front_.linear().transpose() * front_.joint->axis;
      limit(joint, depth, 60, 0.5);
    }
    write_box(front, depth);
  }

  /// Sides and back stand on the edges of the bottom; the box is a little smaller than the front.
  void write_box(const std::string& front, double depth) {
    const Vector2d size(body_.drawer.sizes().x(), body_.panel.sizes().y()),
        centre(body_.drawer.center().x(), body_.panel.center().y());
    const double runner = std::min(kFurniture.runner_m, 0.1 * size.x());
    const double board = std::min(kFurniture.board_m, 0.1 * size.minCoeff());
    const double inner_width = size.x() - 2 * (runner + board);
    const double floor = centre.y() - 0.45 * size.y();  // underside of the bottom
    const double top = floor + 0.65 * size.y();         // of the sides
    const double middle_x = -kFurniture.panel_m - depth / 2;
    const double middle_z = (floor + top) / 2;
    const double side_y = inner_width / 2 + board / 2;
    const Vector3d side(depth, board, top - floor);
    write_side("_left", front, at(middle_x, centre.x() + side_y, middle_z), side, Vector3d::UnitY());
    write_side("_right", front, at(middle_x, centre.x() - side_y, middle_z), side, -Vector3d::UnitY());
    write_side("_back", front, at(-kFurniture.panel_m - depth + board / 2, centre.x(), middle_z),
               {board, inner_width, top - floor}, Vector3d::UnitX());
    write_bottom(front, at(middle_x + board / 2, centre.x(), floor + board),
                 {depth - board, inner_width, board});
  }

  void write_side(const char* suffix, const std::string& front, const Isometry3d& front_from_side,
                  const Vector3d& size, const Vector3d& outward) {
    const std::string name = front_.name + suffix;
    add_link(world_, name, "drawer_side", front, front_from_side, {box_part(Vector3d::Zero(), size)});
    const Isometry3d map_from_side = map_from_front_ * front_from_side;
    const double width = std::abs(outward.y()) > 0.5 ? size.x() : size.y();
    SemanticLink& link = inferred(name, "drawer_side");
    link.geometry = {{"centre", json_from_vector(map_from_side.translation())},
                     {"normal", json_from_vector(map_from_side.linear() * outward)},
                     {"up", json_from_vector(map_from_side.linear() * Vector3d::UnitZ())},
                     {"width", width},
                     {"height", size.z()}};
  }

  /// A support: its origin is at the centre of its top.
  void write_bottom(const std::string& front, const Isometry3d& front_from_bottom, const Vector3d& size) {
    const std::string name = front_.name + "_bottom";
    add_link(world_, name, "drawer_bottom", front, front_from_bottom,
             {box_part({0, 0, -size.z() / 2}, size)});
    const Isometry3d map_from_bottom = map_from_front_ * front_from_bottom;
    Json outline = Json::array();
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Vector3d corner = map_from_bottom * Vector3d(x * size.x() / 2, y * size.y() / 2, 0);
      outline.push_back({corner.x(), corner.y()});
    }
    SemanticLink& link = inferred(name, "drawer_bottom");
    link.geometry = {{"height", map_from_bottom.translation().z()}, {"outline", outline}};
  }

  /// A part of the prototype, inferred from the front and not observed.
  SemanticLink& inferred(const std::string& name, const char* class_name) {
    SemanticLink& link = semantics_.links[name] = SemanticLink{};
    link.class_name = class_name;
    link.confidence = front_.confidence;
    link.evidence = {{"source", "prototype"}, {"depth", front_.depth_measured ? "measured" : "assumed"}};
    return link;
  }

  /// A hinged link has its origin in the hinge; the front's frame is the link NAME_front.
  void write_hinged() {
    Isometry3d map_from_link = map_from_front_;
    map_from_link.translation() = fitted_hinge(front_, body_);
    Joint& joint = write_panel(front_.name, parent_, map_from_parent_.inverse() * map_from_link,
                               map_from_link.inverse() * map_from_front_);
    joint.type = JointType::revolute;
    joint.axis = map_from_link.linear().transpose() * front_.joint->axis;
    limit(joint, kPi / 2, std::max(20.0, 2 * weight_torque(map_from_link.translation())), 1);
  }

  /// What holds the panel of a flap up, N m.
  double weight_torque(const Vector3d& hinge) const {
    const double weight =
        kStandardGravity * kFurniture.wood_density * kFurniture.panel_m * body_.panel.sizes().prod();
    return weight * front_.joint->axis.normalized().head<2>().norm() * (front_.centre - hinge).norm();
  }

  /// Unknown limits become usual ones, as simulators need limits.
  void limit(Joint& joint, double usual, double effort, double velocity) const {
    const JointEstimate& estimate = *front_.joint;
    const bool known = estimate.upper > estimate.lower;
    joint.limits = JointLimits{known ? estimate.lower : 0, known ? estimate.upper : usual, effort, velocity};
    joint.dynamics = JointDynamics{1, 0.5};
  }

  void write_fixture(const Fixture& fixture, const std::string& parent) {
    const Fixture fitted = fitted_fixture(front_, body_);
    const bool bar = fixture.kind == Fixture::Kind::handle;
    const std::string class_name = bar ? "handle" : "knob";
    const std::string name = front_.name + "_" + class_name;
    const Vector3d centre = map_from_front_.inverse() * fixture.centre;
    const Vector3d shift = map_from_front_.inverse() * fitted.centre - centre;
    const Vector3d axis = map_from_front_.linear().transpose() * fixture.axis.normalized();
    std::vector<LinkPart> parts = bar ? bar_parts(fitted, axis, centre.x()) : knob_parts(fitted, centre.x());
    for (LinkPart& part : parts) part.link_from_part.pretranslate(shift);
    add_link(world_, name, class_name, parent, at(centre.x(), centre.y(), centre.z()), parts);
    SemanticLink& link = semantics_.links[name] = SemanticLink{};
    link.class_name = class_name;
    link.confidence = fixture.confidence;
    link.geometry = {{"centre", json_from_vector(fixture.centre)},
                     {"axis", json_from_vector(fixture.axis)},
                     {"length", fixture.length},
                     {"radius", fixture.radius},
                     {"protrusion", fixture.protrusion}};
    link.evidence = fixture.evidence;
  }

  /// A bar on two posts that reach the front's plane, `before` metres behind the bar's axis.
  static std::vector<LinkPart> bar_parts(const Fixture& fixture, const Vector3d& axis, double before) {
    const Vector3d half = std::max(fixture.length, 2 * fixture.radius) / 2 * axis;
    std::vector<LinkPart> parts = {rod_part(-half, half, fixture.radius, kFurniture.steel_density)};
    for (const double side : {-1.0, 1.0}) {
      const Vector3d top = side * (1 - 2 * kFurniture.post_inset) * half;
      const double reach = before + top.x();
      if (reach > fixture.radius)
        parts.push_back(
            rod_part(top - reach * Vector3d::UnitX(), top, 0.8 * fixture.radius, kFurniture.steel_density));
    }
    return parts;
  }

  /// A head at the knob's centre on a neck.
  static std::vector<LinkPart> knob_parts(const Fixture& fixture, double before) {
    const double half = std::clamp(before / 2, 0.003, 0.01);
    const Vector3d out = Vector3d::UnitX();
    std::vector<LinkPart> parts = {
        rod_part(-half * out, half * out, fixture.radius, kFurniture.steel_density)};
    if (before > half + 1e-3)
      parts.push_back(rod_part(-before * out, -half * out, 0.5 * fixture.radius, kFurniture.steel_density));
    return parts;
  }

  void describe_front(const std::string& name) {
    SemanticLink& link = semantics_.links[name] = SemanticLink{};
    link.class_name = front_.class_name;
    link.confidence = front_.confidence;
    link.geometry = {{"centre", json_from_vector(front_.centre)},
                     {"normal", json_from_vector(front_.normal)},
                     {"up", json_from_vector(front_.up)},
                     {"width", front_.width},
                     {"height", front_.height},
                     {"depth", front_.depth}};
    link.evidence = front_.evidence;
    link.appliance = front_.appliance;
    link.extra["depth_measured"] = front_.depth_measured;
    if (!front_.joint) return;
    link.extra["joint_evidence"] = front_.joint->evidence;
    if (!front_.joint->hinge_from.empty()) link.extra["hinge_from"] = front_.joint->hinge_from;
    Json& probabilities = link.extra["joint_probabilities"] = Json::object();
    for (const ArticulationType type : kTypes)
      probabilities[to_text(type)] = front_.joint->probabilities[static_cast<size_t>(type)];
    link.extra["joint_uncertainty"] = {{"axis_sd_deg", front_.joint->axis_sd_deg},
                                       {"origin_sd_m", front_.joint->origin_sd_m}};
  }

  const Front& front_;
  const FrontBody& body_;
  World& world_;
  SemanticMap& semantics_;
  std::string parent_;
  Isometry3d map_from_parent_;
  Isometry3d map_from_front_;
};

}  // namespace

void add_front(const Front& front, const std::string& parent, World& world, SemanticMap& semantics) {
  add_fronts(std::vector<Front>{front}, parent, world, semantics);
}

void add_fronts(const std::vector<Front>& fronts, const std::string& parent, World& world,
                SemanticMap& semantics) {
  for (const Front& front : fronts) {
    if (front.name.empty()) throw Error("a front needs a name before it becomes a link");
    if (!(front.width > 0 && front.height > 0))
      throw Error("the front '" + front.name + "' has no width or height");
    if (front_link(front.name, semantics))
      throw Error("the map has a front '" + front.name + "' already", {}, "remove it first");
  }
  const std::vector<FrontBody> bodies = fit_fronts(fronts, world, semantics);
  cut_supports(fronts, bodies, world, semantics);
  for (size_t i = 0; i < fronts.size(); ++i)
    FrontWriter(fronts[i], bodies[i], parent, world, semantics).write();
  clear_closed_state(fronts, world, semantics);
  limit_joints(fronts, world, semantics);
}

void remove_front(const std::string& name, World& world, SemanticMap& semantics) {
  const std::optional<std::string> link = front_link(name, semantics);
  if (!link) throw Error("the map has no front '" + name + "'");
  std::vector<std::string> gone = {*link};
  for (size_t i = 0; i < gone.size(); ++i)
    for (const Joint& joint : world.joints)
      if (joint.parent == gone[i]) gone.push_back(joint.child);
  const auto is_gone = [&](const std::string& other) { return std::ranges::find(gone, other) != gone.end(); };
  std::erase_if(world.links, [&](const Link& other) { return is_gone(other.name); });
  std::erase_if(world.joints, [&](const Joint& joint) { return is_gone(joint.child); });
  for (const std::string& other : gone) semantics.links.erase(other);
}

namespace {

constexpr std::string_view kSuffix = "_front";

bool is_front(const SemanticLink& link) {
  return link.class_name == "front" || link.class_name == "drawer" || link.class_name == "door" ||
         link.class_name == "flap";
}

std::string base_name(const std::string& link) {
  return link.ends_with(kSuffix) && link.size() > kSuffix.size()
             ? link.substr(0, link.size() - kSuffix.size())
             : link;
}

class FrontReader {
 public:
  FrontReader(const World& world, const SemanticMap& semantics)
      : world_(world), semantics_(semantics), map_from_link_(root_from_links(world, {})) {}

  Front read(const std::string& name, const SemanticLink& link) const {
    Front front;
    front.name = base_name(name);
    front.class_name = link.class_name;
    front.centre = vector_from_json(link.geometry.at("centre"));
    front.normal = vector_from_json(link.geometry.at("normal"));
    front.up = vector_from_json(link.geometry.at("up"));
    front.width = link.geometry.at("width").get<double>();
    front.height = link.geometry.at("height").get<double>();
    front.depth = link.geometry.value("depth", front.depth);
    front.depth_measured = link.extra.value("depth_measured", false);
    front.appliance = link.appliance;
    front.confidence = link.confidence;
    if (link.evidence.is_object()) front.evidence = link.evidence;
    front.joint = joint_of(name, link);
    front.fixture = fixture_of(name, front);
    return front;
  }

 private:
  std::optional<JointEstimate> joint_of(const std::string& name, const SemanticLink& link) const {
    if (world_.find_link(name) == nullptr) return std::nullopt;  // a sidecar without its world
    const Joint* moving = moving_joint(world_, name);
    JointEstimate estimate;
    if (moving != nullptr) {
      const Isometry3d& map_from_joint = map_from_link_[world_.link_index(moving->child)];
      estimate.type =
          moving->type == JointType::prismatic ? ArticulationType::prismatic : ArticulationType::revolute;
      estimate.axis = map_from_joint.linear() * moving->axis.normalized();
      if (estimate.type == ArticulationType::revolute) estimate.origin = map_from_joint.translation();
      if (moving->limits) {
        estimate.lower = moving->limits->lower;
        estimate.upper = moving->limits->upper;
      }
    } else if (!link.extra.contains("joint_evidence")) {
      return std::nullopt;
    }
    estimate.evidence = link.extra.value("joint_evidence", estimate.evidence);
    estimate.hinge_from = link.extra.value("hinge_from", "");
    const Json probabilities = link.extra.value("joint_probabilities", Json::object());
    estimate.probabilities = {};
    for (size_t i = 0; i < estimate.probabilities.size(); ++i) {
      const auto type = static_cast<ArticulationType>(i);
      estimate.probabilities[i] =
          probabilities.empty() ? (type == estimate.type ? 1 : 0) : probabilities.value(to_text(type), 0.0);
    }
    const Json uncertainty = link.extra.value("joint_uncertainty", Json::object());
    estimate.axis_sd_deg = uncertainty.value("axis_sd_deg", 0.0);
    estimate.origin_sd_m = uncertainty.value("origin_sd_m", 0.0);
    return estimate;
  }

  /// The first handle or knob that is fixed to a link, directly or through others.
  std::optional<Fixture> fixture_of(const std::string& name, const Front& front) const {
    std::vector<std::string> open = {name};
    for (size_t i = 0; i < open.size(); ++i) {
      const auto found = semantics_.links.find(open[i]);
      if (found != semantics_.links.end() &&
          (found->second.class_name == "handle" || found->second.class_name == "knob"))
        return read_fixture(found->second, front);
      for (const Joint& joint : world_.joints)
        if (joint.parent == open[i] && joint.type == JointType::fixed) open.push_back(joint.child);
    }
    return std::nullopt;
  }

  static Fixture read_fixture(const SemanticLink& link, const Front& front) {
    Fixture fixture;
    fixture.kind = link.class_name == "knob" ? Fixture::Kind::knob : Fixture::Kind::handle;
    fixture.centre = vector_from_json(link.geometry.at("centre"));
    fixture.axis = link.geometry.contains("axis") ? vector_from_json(link.geometry.at("axis")) : front.normal;
    fixture.length = link.geometry.value("length", 0.0);
    fixture.radius = link.geometry.value("radius", fixture.radius);
    fixture.protrusion = link.geometry.value("protrusion", front.normal.dot(fixture.centre - front.centre));
    fixture.confidence = link.confidence;
    if (link.evidence.is_object()) fixture.evidence = link.evidence;
    return fixture;
  }

  const World& world_;
  const SemanticMap& semantics_;
  std::vector<Isometry3d> map_from_link_;
};

}  // namespace

std::optional<std::string> front_link(const std::string& name, const SemanticMap& semantics) {
  for (const std::string& link : {name + std::string(kSuffix), name}) {
    const auto found = semantics.links.find(link);
    if (found != semantics.links.end() && is_front(found->second)) return link;
  }
  return std::nullopt;
}

std::vector<Front> fronts_of(const World& world, const SemanticMap& semantics) {
  const FrontReader reader(world, semantics);
  std::vector<Front> fronts;
  for (const auto& [name, link] : semantics.links) {
    if (!is_front(link) || !link.geometry.contains("centre")) continue;
    try {
      fronts.push_back(reader.read(name, link));
    } catch (const Json::exception&) {
      throw Error("the geometry or joint of the front '" + name +
                  "' in the sidecar lacks what its class needs");
    }
  }
  return fronts;
}

}  // namespace loci::mapping
