#include "mapping/exchange/formats/owl.h"

#include <array>

#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/owl_document.h"
#include "mapping/exchange/map_structure.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

using tinyxml2::XMLElement;

/// Extends a box by the primitives of a link.
void extend_by(const Link& link, const Isometry3d& frame_from_link, Eigen::AlignedBox3d& box) {
  for (const Visual& visual : link.visuals) {
    Vector3d half;
    if (const auto* cuboid = std::get_if<Box>(&visual.geometry))
      half = cuboid->size / 2;
    else if (const auto* rod = std::get_if<Cylinder>(&visual.geometry))
      half = {rod->radius, rod->radius, rod->length / 2};
    else if (const auto* ball = std::get_if<Sphere>(&visual.geometry))
      half = Vector3d::Constant(ball->radius);
    else
      continue;
    const Isometry3d pose = frame_from_link * visual.link_from_visual;
    const Vector3d reach = pose.linear().cwiseAbs() * half;
    box.extend(pose.translation() - reach);
    box.extend(pose.translation() + reach);
  }
}

class OwlWriter {
 public:
  OwlWriter(const World& world, const SemanticMap& semantics, const std::string& name, int64_t time_ns)
      : world_(world),
        semantics_(semantics),
        map_(owl_identifier(name)),
        root_from_link_(root_from_links(world, {})),
        document_(name) {
    document_.individual(map_, "SemanticEnvironmentMap");
    time_ = document_.timepoint(time_ns);
  }

  std::string text() {
    for (const Link& link : world_.links)
      if (const auto entry = semantics_.links.find(link.name); entry != semantics_.links.end())
        add_link(link, entry->second);
    for (const Joint& joint : world_.joints)
      if (joint.type != JointType::fixed && joint.type != JointType::floating) add_joint(joint);
    return document_.text();
  }

 private:
  void add_link(const Link& link, const SemanticLink& entry) {
    XMLElement& node = document_.individual(link.name, knowrob_class(entry));
    document_.relate(node, "describedInMap", map_);
    if (const std::optional<Vector3d> size = size_of(link, entry)) {
      document_.state(node, "depthOfObject", size->x());
      document_.state(node, "widthOfObject", size->y());
      document_.state(node, "heightOfObject", size->z());
    }
    document_.state_own(node, "urdfName", "string", link.name);
    document_.state_own(node, "confidence", "double", OwlDocument::number(entry.confidence));
    for (const std::string& alias : entry.aliases) document_.label(node, alias);
    for (const Joint& joint : world_.joints) {
      if (joint.parent != link.name || !semantics_.links.contains(joint.child)) continue;
      document_.relate(node, "properPhysicalParts", joint.child);
      if (joint.type == JointType::prismatic) document_.relate(node, "prismaticallyConnectedTo", joint.child);
      if (joint.type == JointType::revolute || joint.type == JointType::continuous)
        document_.relate(node, "hingedTo", joint.child);
    }
    add_perception(link.name, root_from_link_[world_.link_index(link.name)]);
  }

  /// Depth, width, height: the box of its primitives in its axes. A drawer goes as deep as its sides; the
  /// face of a front is as large as it was measured.
  std::optional<Vector3d> size_of(const Link& link, const SemanticLink& entry) const {
    Eigen::AlignedBox3d box;
    extend_by(link, Isometry3d::Identity(), box);
    if (box.isEmpty()) return std::nullopt;
    for (const Joint& joint : world_.joints) {
      const auto part = semantics_.links.find(joint.child);
      if (joint.parent == link.name && part != semantics_.links.end() &&
          part->second.class_name.starts_with("drawer_"))
        extend_by(*world_.find_link(joint.child), joint.parent_from_joint, box);
    }
    Vector3d size = box.sizes();
    if (entry.geometry.contains("width")) size.y() = entry.geometry.at("width").get<double>();
    if (entry.geometry.contains("width") && entry.geometry.contains("height"))
      size.z() = entry.geometry.at("height").get<double>();
    return size;
  }

  /// Where and when something was seen, as KnowRob keeps poses.
  void add_perception(const std::string& of, const Isometry3d& pose) {
    XMLElement& perception = document_.individual("perception_" + of, "SemanticMapPerception");
    document_.relate(perception, "objectActedOn", of);
    document_.relate(perception, "eventOccursAt", "pose_" + of);
    document_.relate(perception, "startTime", time_);
    document_.add_matrix("pose_" + of, pose);
  }

  void add_joint(const Joint& joint) {
    const bool slides = joint.type == JointType::prismatic;
    const Isometry3d& pose = root_from_link_[world_.link_index(joint.child)];
    XMLElement& node = document_.individual(joint.name, slides ? "PrismaticJoint" : "HingedJoint");
    document_.relate(node, "describedInMap", map_);
    document_.relate(node, "connectedTo-Rigidly", joint.parent);
    document_.relate(node, "connectedTo-Rigidly", joint.child);
    if (joint.limits) {
      document_.state(node, "minJointValue", joint.limits->lower);
      document_.state(node, "maxJointValue", joint.limits->upper);
    }
    document_.relate(node, "direction", "direction_" + joint.name);
    add_belief(node, joint.child);
    if (const std::optional<double> radius = slides ? std::nullopt : turn_radius(joint, pose))
      document_.state(node, "turnRadius", *radius);
    const Vector3d axis = pose.linear() * joint.axis.normalized();
    XMLElement& direction = document_.individual("direction_" + joint.name, "Vector");
    document_.state(direction, "vectorX", axis.x());
    document_.state(direction, "vectorY", axis.y());
    document_.state(direction, "vectorZ", axis.z());
    add_perception(joint.name, pose);
  }

  /// How sure it is that the joint is of this type, and how that is known.
  void add_belief(XMLElement& node, const std::string& link) {
    const auto entry = semantics_.links.find(link);
    if (entry == semantics_.links.end()) return;
    const Json& extra = entry->second.extra;
    if (extra.contains("joint_evidence"))
      document_.state_own(node, "jointEvidence", "string", extra["joint_evidence"].get<std::string>());
    const Json probabilities = extra.value("joint_probabilities", Json::object());
    for (const auto& [type, probability] : probabilities.items())
      document_.state_own(node, "probability-" + type, "double",
                          OwlDocument::number(probability.get<double>()));
  }

  /// From the hinge to the handle, or else to the front's middle.
  std::optional<double> turn_radius(const Joint& joint, const Isometry3d& pose) const {
    std::optional<Vector3d> point;
    std::vector<std::string> open = {joint.child};
    for (size_t i = 0; i < open.size(); ++i) {
      const auto entry = semantics_.links.find(open[i]);
      const bool placed = entry != semantics_.links.end() && entry->second.geometry.contains("centre");
      const bool handle =
          placed && (entry->second.class_name == "handle" || entry->second.class_name == "knob");
      if (placed && (!point || handle)) point = vector_from_json(entry->second.geometry["centre"]);
      if (handle) break;
      for (const Joint& below : world_.joints)
        if (below.parent == open[i]) open.push_back(below.child);
    }
    if (!point) return std::nullopt;
    const Vector3d axis = pose.linear() * joint.axis.normalized();
    return (*point - pose.translation()).cross(axis).norm();
  }

  const World& world_;
  const SemanticMap& semantics_;
  std::string map_, time_;
  std::vector<Isometry3d> root_from_link_;
  OwlDocument document_;
};

}  // namespace

std::string knowrob_class(const SemanticLink& link) {
  using Name = std::pair<const char*, const char*>;
  static constexpr std::array<Name, 6> kAppliances = {{{"fridge", "Refrigerator"},
                                                       {"oven", "Oven"},
                                                       {"dishwasher", "Dishwasher"},
                                                       {"sink", "Sink"},
                                                       {"stove", "StoveTop"},
                                                       {"microwave", "MicrowaveOven"}}};
  static constexpr std::array<Name, 15> kClasses = {{{"floor", "FloorOfARoom"},
                                                     {"ceiling", "CeilingOfARoom"},
                                                     {"wall", "WallOfARoom"},
                                                     {"counter", "CounterTop"},
                                                     {"island", "KitchenIsland"},
                                                     {"table", "Table-PieceOfFurniture"},
                                                     {"shelf", "Shelf"},
                                                     {"cabinet", "Cupboard"},
                                                     {"front", "FurnitureFront"},
                                                     {"drawer", "Drawer"},
                                                     {"door", "Door"},
                                                     {"flap", "Flap"},
                                                     {"handle", "Handle"},
                                                     {"knob", "Knob"},
                                                     {"drawer_bottom", "DrawerBottom"}}};
  for (const auto& [name, class_name] : kAppliances)
    if (link.appliance == name) return class_name;
  for (const auto& [name, class_name] : kClasses)
    if (link.class_name == name) return class_name;
  return link.class_name == "drawer_side" ? "DrawerSide" : "HumanScaleObject";
}

std::string owl_text(const World& world, const SemanticMap& semantics, const std::string& name,
                     int64_t time_ns) {
  return OwlWriter(world, semantics, name, time_ns).text();
}

}  // namespace loci::mapping
