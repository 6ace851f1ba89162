#include "mapping/exchange/owl.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mapping/base/json.h"
#include "mapping/world/kinematics.h"

namespace loci {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kKnowRob = "http://knowrob.org/kb/knowrob.owl#";
constexpr const char* kXsd = "http://www.w3.org/2001/XMLSchema#";

/// What is within reach of a name in OWL: letters, digits, underscore, hyphen.
std::string identifier(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return !std::isalnum(c) && c != '_' && c != '-'; }, '_');
  return name;
}

Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// Depth, width, height of a link's shape: the box of its primitives in the link's axes.
std::optional<Vector3d> size_of(const Link& link) {
  Eigen::AlignedBox3d box;
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
    const Vector3d reach = visual.link_from_visual.linear().cwiseAbs() * half;
    box.extend(visual.link_from_visual.translation() - reach);
    box.extend(visual.link_from_visual.translation() + reach);
  }
  if (box.isEmpty()) return std::nullopt;
  return box.sizes();
}

class Writer {
 public:
  Writer(const World& world, const SemanticMap& semantics, const std::string& name, int64_t time_ns)
      : world_(world),
        semantics_(semantics),
        base_("http://knowrob.org/kb/" + identifier(name) + ".owl"),
        map_(identifier(name)),
        time_("timepoint_" + std::to_string(time_ns / 1'000'000'000)),
        root_from_link_(root_from_links(world, {})) {}

  std::string text() {
    document_.InsertEndChild(document_.NewDeclaration());
    XMLElement* rdf = document_.NewElement("rdf:RDF");
    document_.InsertEndChild(rdf);
    rdf_ = rdf;
    const auto space = [&](const char* attribute, const std::string& uri) {
      rdf->SetAttribute(attribute, uri.c_str());
    };
    space("xmlns", base_ + "#");
    space("xml:base", base_);
    space("xmlns:rdf", "http://www.w3.org/1999/02/22-rdf-syntax-ns#");
    space("xmlns:rdfs", "http://www.w3.org/2000/01/rdf-schema#");
    space("xmlns:owl", "http://www.w3.org/2002/07/owl#");
    space("xmlns:xsd", kXsd);
    space("xmlns:knowrob", kKnowRob);
    XMLElement& ontology = top("owl:Ontology", base_);
    resource(ontology, "owl:imports", "package://knowrob_common/owl/knowrob.owl");

    individual(map_, "SemanticEnvironmentMap");
    individual(time_, "TimePoint");
    for (const Link& link : world_.links)
      if (const auto entry = semantics_.links.find(link.name); entry != semantics_.links.end())
        add_link(link, entry->second);
    for (const Joint& joint : world_.joints)
      if (joint.type != JointType::fixed && joint.type != JointType::floating) add_joint(joint);
    declare();
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  XMLElement& top(const char* element, const std::string& about) {
    XMLElement& node = *rdf_->InsertNewChildElement(element);
    node.SetAttribute("rdf:about", about.c_str());
    return node;
  }

  static void resource(XMLElement& parent, const char* property, const std::string& uri) {
    parent.InsertNewChildElement(property)->SetAttribute("rdf:resource", uri.c_str());
  }

  XMLElement& individual(const std::string& name, const std::string& class_name) {
    XMLElement& node = top("owl:NamedIndividual", own(name));
    resource(node, "rdf:type", kKnowRob + class_name);
    classes_.insert(class_name);
    return node;
  }

  std::string own(const std::string& name) const { return base_ + "#" + identifier(name); }

  /// A property whose value is another individual.
  void relate(XMLElement& node, const std::string& property, const std::string& name) {
    object_properties_.insert(property);
    resource(node, ("knowrob:" + property).c_str(), own(name));
  }

  void state(XMLElement& node, const std::string& property, const char* type, const std::string& value) {
    data_properties_.insert(property);
    XMLElement* element = node.InsertNewChildElement(("knowrob:" + property).c_str());
    element->SetAttribute("rdf:datatype", (kXsd + std::string(type)).c_str());
    element->SetText(value.c_str());
  }
  void state(XMLElement& node, const std::string& property, double value) {
    state(node, property, "double", number(value));
  }

  /// A property that KnowRob does not have, in the map's own namespace.
  void state_own(XMLElement& node, const std::string& property, const char* type, const std::string& value) {
    own_properties_.insert(property);
    XMLElement* element = node.InsertNewChildElement(property.c_str());
    element->SetAttribute("rdf:datatype", (kXsd + std::string(type)).c_str());
    element->SetText(value.c_str());
  }

  static std::string number(double value) { return fmt::format("{}", value == 0 ? 0.0 : value); }

  void add_link(const Link& link, const SemanticLink& entry) {
    XMLElement& node = individual(link.name, knowrob_class(entry));
    relate(node, "describedInMap", map_);
    if (const std::optional<Vector3d> size = size_of(link)) {
      state(node, "depthOfObject", size->x());
      state(node, "widthOfObject", size->y());
      state(node, "heightOfObject", size->z());
    }
    state_own(node, "urdfName", "string", link.name);
    state_own(node, "confidence", "double", number(entry.confidence));
    for (const std::string& alias : entry.aliases) {
      XMLElement* label = node.InsertNewChildElement("rdfs:label");
      label->SetText(alias.c_str());
    }
    for (const Joint& joint : world_.joints) {
      if (joint.parent != link.name || !semantics_.links.contains(joint.child)) continue;
      relate(node, "properPhysicalParts", joint.child);
      if (joint.type == JointType::prismatic) relate(node, "prismaticallyConnectedTo", joint.child);
      if (joint.type == JointType::revolute || joint.type == JointType::continuous)
        relate(node, "hingedTo", joint.child);
    }
    add_perception(link.name, root_from_link_[world_.link_index(link.name)]);
  }

  /// Where and when something was seen, as KnowRob keeps poses.
  void add_perception(const std::string& of, const Isometry3d& pose) {
    XMLElement& perception = individual("perception_" + of, "SemanticMapPerception");
    relate(perception, "objectActedOn", of);
    relate(perception, "eventOccursAt", "pose_" + of);
    relate(perception, "startTime", time_);
    XMLElement& matrix = individual("pose_" + of, "RotationMatrix3D");
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        state(matrix, fmt::format("m{}{}", row, column), pose.matrix()(row, column));
  }

  void add_joint(const Joint& joint) {
    const bool slides = joint.type == JointType::prismatic;
    const Isometry3d& pose = root_from_link_[world_.link_index(joint.child)];
    XMLElement& node = individual(joint.name, slides ? "PrismaticJoint" : "HingedJoint");
    relate(node, "describedInMap", map_);
    relate(node, "connectedTo-Rigidly", joint.parent);
    relate(node, "connectedTo-Rigidly", joint.child);
    if (joint.limits) {
      state(node, "minJointValue", joint.limits->lower);
      state(node, "maxJointValue", joint.limits->upper);
    }
    relate(node, "direction", "direction_" + joint.name);
    add_belief(node, joint.child);
    if (const std::optional<double> radius = slides ? std::nullopt : turn_radius(joint, pose))
      state(node, "turnRadius", *radius);
    const Vector3d axis = pose.linear() * joint.axis.normalized();
    XMLElement& direction = individual("direction_" + joint.name, "Vector");
    state(direction, "vectorX", axis.x());
    state(direction, "vectorY", axis.y());
    state(direction, "vectorZ", axis.z());
    add_perception(joint.name, pose);
  }

  /// How sure it is that the joint is of this type, and how that is known.
  void add_belief(XMLElement& node, const std::string& link) {
    const auto entry = semantics_.links.find(link);
    if (entry == semantics_.links.end()) return;
    const Json& extra = entry->second.extra;
    if (extra.contains("joint_evidence"))
      state_own(node, "jointEvidence", "string", extra["joint_evidence"].get<std::string>());
    const Json probabilities = extra.value("joint_probabilities", Json::object());
    for (const auto& [type, probability] : probabilities.items())
      state_own(node, "probability-" + type, "double", number(probability.get<double>()));
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
      if (placed && (!point || handle)) point = vector_of(entry->second.geometry["centre"]);
      if (handle) break;
      for (const Joint& below : world_.joints)
        if (below.parent == open[i]) open.push_back(below.child);
    }
    if (!point) return std::nullopt;
    const Vector3d axis = pose.linear() * joint.axis.normalized();
    return (*point - pose.translation()).cross(axis).norm();
  }

  void declare() {
    for (const std::string& name : classes_) top("owl:Class", kKnowRob + name);
    for (const std::string& name : object_properties_) top("owl:ObjectProperty", kKnowRob + name);
    for (const std::string& name : data_properties_) top("owl:DatatypeProperty", kKnowRob + name);
    for (const std::string& name : own_properties_) top("owl:DatatypeProperty", own(name));
  }

  const World& world_;
  const SemanticMap& semantics_;
  std::string base_, map_, time_;
  std::vector<Isometry3d> root_from_link_;
  tinyxml2::XMLDocument document_;
  XMLElement* rdf_ = nullptr;
  std::set<std::string> classes_, object_properties_, data_properties_, own_properties_;
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
  return Writer(world, semantics, name, time_ns).text();
}

}  // namespace loci
