#include "mapping/simulation/play.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

constexpr const char* kBottom = "_bottom";

/// Bounds of an object's mesh after a turn.
Eigen::AlignedBox3d turned_bounds(const ObjectModel& model, const Eigen::Matrix3d& turn) {
  Eigen::AlignedBox3d bounds;
  for (const auto& vertex : model.mesh.vertices) bounds.extend(Vector3d(turn * vertex.cast<double>()));
  return bounds;
}

/// The level surface of a link that is largest, in the link's frame.
Eigen::AlignedBox3d largest_level(const Link& link, const MeshSearch& search, Warnings& warnings) {
  struct Level {
    double area = 0;
    Eigen::AlignedBox3d bounds;
  };
  constexpr double kLevel_m = 0.005, kMinUp = 0.95;  // levels; cosine of the tilt
  std::map<long, Level> levels;
  for (const Visual& visual : link.visuals) {
    const TriangleMesh mesh = triangulate(visual.geometry, search, warnings);
    for (const auto& triangle : mesh.triangles) {
      std::array<Vector3d, 3> corners;
      for (size_t i = 0; i < 3; ++i)
        corners[i] = visual.link_from_visual * mesh.vertices[triangle[i]].cast<double>();
      const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      if (normal.z() <= kMinUp * normal.norm()) continue;
      Level& level = levels[std::lround((corners[0] + corners[1] + corners[2]).z() / 3 / kLevel_m)];
      level.area += normal.norm() / 2;
      for (const Vector3d& corner : corners) level.bounds.extend(corner);
    }
  }
  Level largest;
  for (const auto& [height, level] : levels)
    if (level.area > largest.area) largest = level;
  return largest.bounds;
}

SupportTop top_of(const Eigen::AlignedBox3d& bounds) {
  SupportTop top;
  top.centre << bounds.center().head<2>(), bounds.max().z();
  top.half = bounds.sizes().head<2>() / 2;
  return top;
}

}  // namespace

Eigen::AlignedBox3d bounds_of_link(const Link& link, const MeshSearch& search, Warnings& warnings) {
  Eigen::AlignedBox3d bounds;
  for (const Visual& visual : link.visuals)
    for (const auto& vertex : triangulate(visual.geometry, search, warnings).vertices)
      bounds.extend(Vector3d(visual.link_from_visual * vertex.cast<double>()));
  return bounds;
}

std::optional<SupportTop> top_of_link(const Link& link, const MeshSearch& search, Warnings& warnings) {
  const Eigen::AlignedBox3d bounds = bounds_of_link(link, search, warnings);
  if (bounds.isEmpty()) return std::nullopt;
  return top_of(bounds);
}

std::optional<SupportTop> inside_of_drawer(const Link& link, const Vector3d& out, double travel,
                                           const MeshSearch& search, Warnings& warnings) {
  constexpr double kBoard_m = 0.012;  // thickness of a bottom that nobody modelled
  const Eigen::AlignedBox3d bounds = bounds_of_link(link, search, warnings);
  if (bounds.isEmpty()) return std::nullopt;
  const Eigen::AlignedBox3d level = largest_level(link, search, warnings);
  if (!level.isEmpty() && bounds.max().z() - level.max().z() > kBoard_m) return top_of(level);
  // What is half as thick as it opens is a solid body, or a panel that slides along its plane.
  const double thickness = out.cwiseAbs().dot(bounds.sizes());
  if (thickness > travel / 2) return std::nullopt;
  const Vector3d reach = out.cwiseAbs() * travel / 2,
                 behind = bounds.center() - out * (thickness + travel) / 2;
  Vector3d half = bounds.sizes() / 2 - out.cwiseAbs() * thickness / 2 + reach;
  SupportTop top;
  top.centre << behind.head<2>(), bounds.min().z() + kBoard_m;
  top.half = half.head<2>();
  return top;
}

ScenarioPlay::ScenarioPlay(const Scenario& scenario, const World& world, const MeshSearch& search)
    : scenario_(scenario), world_(world), search_(search), map_from_closed_(root_from_links(world, {})) {
  for (const auto& [name, spec] : scenario.objects) {
    if (world.find_link(name) != nullptr)
      throw Error("the object '" + name + "' has the name of a link of the world",
                  {scenario.file.string(), 0, {}});
    models_[name] = build_object(spec);
  }
  WorldState state;
  for (const SceneSpec& scene : scenario.scenes) {
    for (const Action& action : scene.actions) apply(action, state);
    states_.push_back(state);
  }
}

void ScenarioPlay::apply(const Action& action, WorldState& state) {
  if (action.kind == Action::Kind::open) return move_joint(action, state);
  if (action.kind == Action::Kind::place) return place_object(action, state);
  const auto object = state.objects.find(action.subject);
  if (object == state.objects.end())
    throw Error("'" + action.subject + "' is not there", action.location, "place it before");
  if (action.kind == Action::Kind::remove) {
    for (const auto& [name, other] : state.objects)
      if (other.support == action.subject)
        throw Error(fmt::format("'{}' stands on '{}'", name, action.subject), action.location,
                    "move it away first");
    state.objects.erase(object);
  } else if (action.kind == Action::Kind::turn) {
    object->second.support_from_object.rotate(Eigen::AngleAxisd(*action.yaw, Vector3d::UnitZ()));
  } else {
    if (action.color) object->second.color = *action.color;
    if (action.accent || action.color) object->second.accent = action.accent;
  }
}

void ScenarioPlay::place_object(const Action& action, WorldState& state) {
  const auto before = state.objects.find(action.subject);
  std::string support = before != state.objects.end() ? before->second.support : "";
  if (!action.support.empty()) support = resolve_support(action, state);
  if (support.empty()) throw Error("it is not said where", action.location, "give 'on' or 'in'");
  PlacedObject object;
  const ObjectSpec& spec = scenario_.objects.at(action.subject);
  object.color = before != state.objects.end() ? before->second.color : spec.color;
  object.accent = before != state.objects.end() ? before->second.accent : spec.accent;
  object.support = support;
  object.support_from_object = placed(action, support, state);
  state.objects[action.subject] = object;
}

Isometry3d ScenarioPlay::placed(const Action& action, const std::string& support, const WorldState& state) {
  SupportTop top;
  if (const auto other = models_.find(support); other != models_.end()) {
    const ObjectModel& model = other->second;
    const Eigen::Matrix3d turn = state.objects.at(support).support_from_object.linear();
    const bool upright = turn(2, 2) > 0.99;
    top.centre.z() = upright ? model.top : 0;
    top.half = (model.high - model.low).head<2>() / 2;
    if (!upright) throw Error("'" + support + "' lies on its side, nothing stands on it", action.location);
  } else {
    const Joint* slide = action.inside && !support.ends_with(kBottom) ? slide_of(support) : nullptr;
    top = slide != nullptr ? inside(action, support, *slide) : known_top(support);
  }
  const Vector2d at = action.at.value_or(Vector2d::Zero());
  if (std::abs(at.x()) > top.half.x() || std::abs(at.y()) > top.half.y())
    throw Error(
        fmt::format("[{}, {}] is beside '{}'", at.x(), at.y(), support), action.location,
        fmt::format("its top reaches {:.2f} and {:.2f} m from its middle", top.half.x(), top.half.y()));
  Isometry3d pose = Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(action.yaw.value_or(0), Vector3d::UnitZ()));
  if (action.lying) pose.rotate(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()));
  const Eigen::AlignedBox3d bounds = turned_bounds(models_.at(action.subject), pose.linear());
  if (action.inside) require_room(action, support, top.centre.z(), bounds.sizes().z());
  pose.translation() = top.centre + Vector3d(at.x(), at.y(), -bounds.min().z());
  if (action.lying) pose.translation().head<2>() -= bounds.center().head<2>();
  return pose;
}

SupportTop ScenarioPlay::known_top(const std::string& link) {
  if (const auto known = tops_.find(link); known != tops_.end()) return known->second;
  Warnings warnings;  // The renderer names missing meshes.
  const std::optional<SupportTop> top = top_of_link(*world_.find_link(link), search_, warnings);
  if (!top) throw Error("the link '" + link + "' has no shape to stand on", {scenario_.file.string(), 0, {}});
  return tops_[link] = *top;
}

/// The joint that a link slides along, its own or that of a link which carries it; nullptr = none.
const Joint* ScenarioPlay::slide_of(const std::string& link) const {
  const Joint* joint = moving_joint(world_, link);
  return joint != nullptr && joint->type == JointType::prismatic && joint->limits ? joint : nullptr;
}

SupportTop ScenarioPlay::inside(const Action& action, const std::string& front, const Joint& slide) const {
  Warnings warnings;  // The renderer names missing meshes.
  const JointLimits& limits = *slide.limits;
  const bool forward = limits.upper >= -limits.lower;
  const Eigen::Matrix3d front_from_slide = map_from_closed_[world_.link_index(front)].linear().transpose() *
                                           map_from_closed_[world_.link_index(slide.child)].linear();
  const Vector3d out = front_from_slide * slide.axis.normalized() * (forward ? 1 : -1);
  const std::optional<SupportTop> top = inside_of_drawer(
      *world_.find_link(front), out, forward ? limits.upper : -limits.lower, search_, warnings);
  if (!top)
    throw Error("'" + front + "' has no inside: it has no shape, or a solid one", action.location,
                "give the world a link '" + action.support + kBottom + "'");
  return *top;
}

/// Error for an object that reaches over the upper edge of the drawer that it is to lie in: what is above the
/// drawer would be in its way.
void ScenarioPlay::require_room(const Action& action, const std::string& support, double bottom,
                                double height) const {
  const Joint* slide = slide_of(support);
  if (slide == nullptr) return;
  Warnings warnings;  // The renderer names missing meshes.
  const size_t front = world_.link_index(slide->child);
  double edge = std::numeric_limits<double>::lowest();
  const Eigen::AlignedBox3d bounds = bounds_of_link(world_.links[front], search_, warnings);
  if (bounds.isEmpty()) return;
  for (int corner = 0; corner < 8; ++corner)
    edge = std::max(
        edge,
        (map_from_closed_[front] * bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))).z());
  const double room = edge - (map_from_closed_[world_.link_index(support)] * Vector3d(0, 0, bottom)).z();
  if (height > room)
    throw Error(fmt::format("'{}' is {:.2f} m high, '{}' has room for {:.2f} m", action.subject, height,
                            action.support, room),
                action.location,
                action.lying ? "put it elsewhere" : "lay it on its side (lying: true) or put it elsewhere");
}

std::string ScenarioPlay::resolve_support(const Action& action, const WorldState& state) const {
  const std::string& name = action.support;
  if (action.inside)
    for (const char* part : {kBottom, "", "_front"})
      if (world_.find_link(name + part) != nullptr) return name + part;
  if (!action.inside && models_.contains(name)) {
    if (!state.objects.contains(name))
      throw Error("'" + name + "' is not there", action.location, "place it before");
    for (std::string below = name; models_.contains(below); below = state.objects.at(below).support)
      if (below == action.subject)
        throw Error(fmt::format("'{}' cannot stand on itself", action.subject), action.location);
    return name;
  }
  if (world_.find_link(name) != nullptr) return name;
  std::vector<std::string> candidates;
  for (const Link& link : world_.links) candidates.push_back(link.name);
  for (const auto& [object, model] : models_) candidates.push_back(object);
  throw Error(fmt::format("unknown link '{}'", name), action.location, did_you_mean(name, candidates));
}

std::string ScenarioPlay::resolve_joint(const Action& action) const {
  for (const char* suffix : {"", "_joint", "_front_joint"}) {
    const Joint* joint = world_.find_joint(action.subject + suffix);
    if (joint != nullptr && joint->type != JointType::fixed) return joint->name;
  }
  for (const char* suffix : {"", "_front"}) {
    const Joint* joint = world_.parent_joint(action.subject + suffix);
    if (joint != nullptr && joint->type != JointType::fixed) return joint->name;
  }
  std::vector<std::string> candidates;
  for (const Joint& joint : world_.joints) {
    if (joint.type == JointType::fixed) continue;
    candidates.push_back(joint.name);
    candidates.push_back(joint.child);
    if (joint.child.ends_with("_front")) candidates.push_back(joint.child.substr(0, joint.child.size() - 6));
  }
  throw Error(fmt::format("'{}' does not open", action.subject), action.location,
              did_you_mean(action.subject, candidates));
}

void ScenarioPlay::move_joint(const Action& action, WorldState& state) const {
  const std::string name = resolve_joint(action);
  const Joint& joint = *world_.find_joint(name);
  if (joint.limits && joint.type != JointType::continuous &&
      (action.position < joint.limits->lower - 1e-9 || action.position > joint.limits->upper + 1e-9))
    throw Error(fmt::format("'{}' moves from {} to {}, not to {}", name, joint.limits->lower,
                            joint.limits->upper, action.position),
                action.location);
  state.joints[name] = action.position;
}

std::map<std::string, Isometry3d> ScenarioPlay::map_from_objects(const WorldState& state) const {
  const std::vector<Isometry3d> links = root_from_links(world_, state.joints);
  std::map<std::string, Isometry3d> poses;
  for (const auto& [name, object] : state.objects) {
    Isometry3d pose = object.support_from_object;
    std::string support = object.support;
    while (models_.contains(support)) {
      const PlacedObject& below = state.objects.at(support);
      pose = below.support_from_object * pose;
      support = below.support;
    }
    poses[name] = links[world_.link_index(support)] * pose;
  }
  return poses;
}

}  // namespace loci::mapping
