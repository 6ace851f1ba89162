#include <console_bridge/console.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <mutex>
#include <set>
#include <string_view>

#include "mapping/base/files.h"
#include "mapping/world/urdf.h"
#include "mapping/world/urdf_check.h"

namespace loci::mapping {
namespace {

using tinyxml2::XMLElement;

/// What urdfdom says while it parses: collected instead of printed. The handler of console_bridge is global,
/// so that only one thread parses at a time.
class UrdfdomMessages : public console_bridge::OutputHandler {
 public:
  UrdfdomMessages() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~UrdfdomMessages() override { console_bridge::restorePreviousOutputHandler(); }
  UrdfdomMessages(const UrdfdomMessages&) = delete;
  UrdfdomMessages& operator=(const UrdfdomMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    text_ += (text_.empty() ? "" : "; ") + text;
  }
  const std::string& text() const { return text_; }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }

  std::lock_guard<std::mutex> lock_;
  std::string text_;
};

urdf::ModelInterfaceSharedPtr parse_with_urdfdom(const std::string& text, const std::string& file) {
  UrdfdomMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  std::string reason;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& exception) {
    reason = exception.what();
  }
  if (model) return model;
  if (!messages.text().empty()) reason = messages.text();
  throw Error("urdfdom refuses it: " + (reason.empty() ? "no reason given" : reason),
              FileLocation{file, 0, {}});
}

Vector3d vector_from(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Isometry3d pose_from(const urdf::Pose& pose) {
  Isometry3d result = Isometry3d::Identity();
  const urdf::Rotation& r = pose.rotation;
  result.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix();
  result.translation() = vector_from(pose.position);
  return result;
}

Geometry geometry_from(const urdf::Geometry& geometry) {
  switch (geometry.type) {
    case urdf::Geometry::BOX:
      return Box{vector_from(static_cast<const urdf::Box&>(geometry).dim)};
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      return Cylinder{cylinder.radius, cylinder.length};
    }
    case urdf::Geometry::SPHERE:
      return Sphere{static_cast<const urdf::Sphere&>(geometry).radius};
    default: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      return Mesh{mesh.filename, vector_from(mesh.scale)};
    }
  }
}

std::string xml_text(const XMLElement& element) {
  tinyxml2::XMLPrinter printer(nullptr, true);
  element.Accept(&printer);
  return printer.CStr();
}

/// An element for urdfdom, whose XML reader is another one: without comments, declarations and whatever else
/// the two could understand differently, so that what was checked is what is read.
std::string elements_text(const XMLElement& element) {
  class ElementPrinter : public tinyxml2::XMLPrinter {
   public:
    ElementPrinter() : XMLPrinter(nullptr, true) {}
    bool Visit(const tinyxml2::XMLText& text) override { return XMLPrinter::Visit(text); }
    bool Visit(const tinyxml2::XMLComment&) override { return true; }
    bool Visit(const tinyxml2::XMLDeclaration&) override { return true; }
    bool Visit(const tinyxml2::XMLUnknown&) override { return true; }
  };
  ElementPrinter printer;
  element.Accept(&printer);
  return printer.CStr();
}

/// Child elements that URDF does not define, as text.
std::vector<std::string> unknown_children(const XMLElement& element,
                                          const std::set<std::string_view>& known) {
  std::vector<std::string> texts;
  for (const XMLElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    if (!known.contains(child->Name())) texts.push_back(xml_text(*child));
  return texts;
}

void collect_attributes(const XMLElement& element, const std::set<std::string_view>& known,
                        const std::string& prefix, std::map<std::string, std::string>& attributes) {
  for (const auto* a = element.FirstAttribute(); a; a = a->Next())
    if (!known.contains(a->Name())) attributes[prefix + a->Name()] = a->Value();
}

/// Materials by name, as urdfdom resolves them (the first definition of a name holds); whether a colour was
/// given is only in the XML.
class Materials {
 public:
  explicit Materials(const XMLElement& robot) {
    collect(robot);
    for (const XMLElement* link = robot.FirstChildElement("link"); link;
         link = link->NextSiblingElement("link"))
      for (const XMLElement* v = link->FirstChildElement("visual"); v; v = v->NextSiblingElement("visual"))
        collect(*v);
  }

  /// `element` is the material as it stands at its use: an unnamed one is defined there and nowhere else.
  Material from(const urdf::Material& parsed, const std::string& name, const XMLElement& element) const {
    Material material;
    material.name = name;
    material.texture = parsed.texture_filename;
    if (name.empty() ? element.FirstChildElement("color") != nullptr : colored_.contains(name))
      material.color = Rgba(parsed.color.r, parsed.color.g, parsed.color.b, parsed.color.a);
    return material;
  }

 private:
  void collect(const XMLElement& owner) {
    for (const XMLElement* e = owner.FirstChildElement("material"); e;
         e = e->NextSiblingElement("material")) {
      const bool color = e->FirstChildElement("color"), texture = e->FirstChildElement("texture");
      if (!*e->Attribute("name") || (!color && !texture)) continue;
      if (defined_.insert(e->Attribute("name")).second && color) colored_.insert(e->Attribute("name"));
    }
  }

  std::set<std::string> defined_, colored_;
};

Link link_from(const urdf::Link& parsed, const XMLElement& element, const Materials& materials) {
  Link link;
  link.name = parsed.name;
  if (parsed.inertial) {
    const urdf::Inertial& in = *parsed.inertial;
    link.inertial.emplace();
    link.inertial->link_from_inertial = pose_from(in.origin);
    link.inertial->mass = in.mass;
    link.inertial->inertia << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  }
  const XMLElement* visual_element = element.FirstChildElement("visual");
  for (const auto& v : parsed.visual_array) {
    Visual visual{v->name, pose_from(v->origin), geometry_from(*v->geometry), std::nullopt};
    if (visual_element) {
      const XMLElement* material = visual_element->FirstChildElement("material");
      // urdfdom drops a material that is named but defined nowhere; its name stays.
      if (material)
        visual.material =
            materials.from(v->material ? *v->material : urdf::Material(), v->material_name, *material);
      visual.extensions = unknown_children(*visual_element, {"origin", "geometry", "material"});
      visual_element = visual_element->NextSiblingElement("visual");
    }
    link.visuals.push_back(std::move(visual));
  }
  const XMLElement* collision_element = element.FirstChildElement("collision");
  for (const auto& c : parsed.collision_array) {
    Collision collision{c->name, pose_from(c->origin), geometry_from(*c->geometry)};
    if (collision_element) {
      collision.extensions = unknown_children(*collision_element, {"origin", "geometry"});
      collision_element = collision_element->NextSiblingElement("collision");
    }
    link.collisions.push_back(std::move(collision));
  }
  collect_attributes(element, {"name"}, "", link.attributes);
  link.extensions = unknown_children(element, {"inertial", "visual", "collision"});
  return link;
}

JointType type_from(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return JointType::revolute;
    case urdf::Joint::CONTINUOUS:
      return JointType::continuous;
    case urdf::Joint::PRISMATIC:
      return JointType::prismatic;
    case urdf::Joint::FLOATING:
      return JointType::floating;
    case urdf::Joint::PLANAR:
      return JointType::planar;
    default:
      return JointType::fixed;
  }
}

/// Elements of a joint that URDF defines, with the attributes that it defines.
const std::map<std::string_view, std::set<std::string_view>>& joint_elements() {
  static const std::map<std::string_view, std::set<std::string_view>> elements = {
      {"origin", {"xyz", "rpy"}},
      {"parent", {"link"}},
      {"child", {"link"}},
      {"axis", {"xyz"}},
      {"limit", {"lower", "upper", "effort", "velocity"}},
      {"mimic", {"joint", "multiplier", "offset"}},
      {"safety_controller", {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}},
      {"calibration", {"rising", "falling", "reference_position"}},
      {"dynamics", {"damping", "friction"}}};
  return elements;
}

void keep_joint_extras(const XMLElement& element, Joint& joint) {
  std::set<std::string_view> known;
  collect_attributes(element, {"name", "type"}, "", joint.attributes);
  for (const auto& [name, attributes] : joint_elements()) {
    known.insert(name);
    const std::string tag(name);
    if (const XMLElement* child = element.FirstChildElement(tag.c_str()))
      collect_attributes(*child, attributes, tag + "/", joint.attributes);
  }
  joint.extensions = unknown_children(element, known);
}

Joint joint_from(const urdf::Joint& parsed, const XMLElement& element) {
  Joint joint;
  joint.name = parsed.name;
  joint.type = type_from(parsed);
  joint.parent = parsed.parent_link_name;
  joint.child = parsed.child_link_name;
  joint.parent_from_joint = pose_from(parsed.parent_to_joint_origin_transform);
  if (joint.type != JointType::fixed && joint.type != JointType::floating)
    joint.axis = vector_from(parsed.axis);
  if (parsed.limits)
    joint.limits = JointLimits{parsed.limits->lower, parsed.limits->upper, parsed.limits->effort,
                               parsed.limits->velocity};
  if (parsed.mimic)
    joint.mimic = JointMimic{parsed.mimic->joint_name, parsed.mimic->multiplier, parsed.mimic->offset};
  if (parsed.safety)
    joint.safety = JointSafety{parsed.safety->soft_lower_limit, parsed.safety->soft_upper_limit,
                               parsed.safety->k_position, parsed.safety->k_velocity};
  if (parsed.calibration) {
    joint.calibration.emplace();
    if (parsed.calibration->rising) joint.calibration->rising = *parsed.calibration->rising;
    if (parsed.calibration->falling) joint.calibration->falling = *parsed.calibration->falling;
  }
  if (parsed.dynamics) joint.dynamics = JointDynamics{parsed.dynamics->damping, parsed.dynamics->friction};
  keep_joint_extras(element, joint);
  return joint;
}

void swap_reversed_limits(World& world, const std::string& file, Warnings& warnings) {
  std::vector<std::string> swapped;
  for (Joint& joint : world.joints) {
    const bool limited = joint.type == JointType::revolute || joint.type == JointType::prismatic;
    if (!limited || !joint.limits || joint.limits->lower <= joint.limits->upper) continue;
    std::swap(joint.limits->lower, joint.limits->upper);
    swapped.push_back(joint.name);
  }
  if (!swapped.empty())
    warnings.add(
        fmt::format("the lower limit is above the upper one: swapped, of {}", fmt::join(swapped, ", ")),
        {file, 0, {}});
}

}  // namespace

World parse_urdf(const std::string& text, const std::string& file, Warnings& warnings) {
  tinyxml2::XMLDocument document;
  urdf_detail::parse_xml(document, urdf_detail::utf8_text(text, file), file);
  const XMLElement& robot = urdf_detail::check_urdf(document, file);
  const urdf::ModelInterfaceSharedPtr model = parse_with_urdfdom(elements_text(robot), file);
  const Materials materials(robot);

  World world;
  world.name = model->getName();
  world.root = model->getRoot()->name;
  for (const XMLElement* e = robot.FirstChildElement("material"); e; e = e->NextSiblingElement("material"))
    if (const auto material = model->getMaterial(e->Attribute("name")))
      world.materials.push_back(materials.from(*material, material->name, *e));
  for (const XMLElement* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link"))
    world.links.push_back(link_from(*model->getLink(e->Attribute("name")), *e, materials));
  for (const XMLElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
    world.joints.push_back(joint_from(*model->getJoint(e->Attribute("name")), *e));
  collect_attributes(robot, {"name"}, "", world.attributes);
  world.extensions = unknown_children(robot, {"material", "link", "joint"});
  swap_reversed_limits(world, file, warnings);
  return world;
}

World parse_urdf(const std::string& text, const std::string& file) {
  Warnings unread;
  return parse_urdf(text, file, unread);
}

World read_urdf(const std::filesystem::path& path, Warnings& warnings) {
  return parse_urdf(read_file(path), path.string(), warnings);
}

World read_urdf(const std::filesystem::path& path) {
  Warnings unread;
  return read_urdf(path, unread);
}

}  // namespace loci::mapping
