#include "mapping/exchange/formats/sdf.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>

namespace loci::mapping {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kVersion = "1.7";
constexpr double kFittingMass = 0.01;  // kg, of a link that moves without a shape of its own

std::string text_of(double value) {
  return fmt::format("{}", value == 0 ? 0.0 : value);
}

std::string text_of(const Vector3d& v) {
  return fmt::format("{} {} {}", text_of(v.x()), text_of(v.y()), text_of(v.z()));
}

XMLElement& child(XMLElement& parent, const char* name, const std::string& text = {}) {
  XMLElement& element = *parent.InsertNewChildElement(name);
  if (!text.empty()) element.SetText(text.c_str());
  return element;
}

XMLElement& named(XMLElement& parent, const char* name, const std::string& value) {
  XMLElement& element = child(parent, name);
  element.SetAttribute("name", value.c_str());
  return element;
}

XMLElement& add_pose(XMLElement& parent, const Isometry3d& pose) {
  return child(parent, "pose", text_of(pose.translation()) + " " + text_of(rpy_from_rotation(pose.linear())));
}

/// Gazebo finds the meshes of a package under model://, as its own reader of URDF has it.
std::string mesh_uri(const std::string& uri) {
  constexpr std::string_view kPackage = "package://";
  return uri.starts_with(kPackage) ? "model://" + uri.substr(kPackage.size()) : uri;
}

void add_geometry(XMLElement& parent, const Geometry& geometry) {
  XMLElement& element = child(parent, "geometry");
  if (const Box* box = std::get_if<Box>(&geometry)) {
    child(child(element, "box"), "size", text_of(box->size));
  } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&geometry)) {
    XMLElement& shape = child(element, "cylinder");
    child(shape, "radius", text_of(cylinder->radius));
    child(shape, "length", text_of(cylinder->length));
  } else if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) {
    child(child(element, "sphere"), "radius", text_of(sphere->radius));
  } else {
    const Mesh& mesh = std::get<Mesh>(geometry);
    XMLElement& shape = child(element, "mesh");
    child(shape, "scale", text_of(mesh.scale));
    child(shape, "uri", mesh_uri(mesh.uri));
  }
}

void add_inertial(XMLElement& link, const Inertial& inertial) {
  XMLElement& element = child(link, "inertial");
  add_pose(element, inertial.link_from_inertial);
  child(element, "mass", text_of(inertial.mass));
  XMLElement& inertia = child(element, "inertia");
  constexpr const char* kAxes = "xyz";
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      child(inertia, fmt::format("i{}{}", kAxes[i], kAxes[j]).c_str(), text_of(inertial.inertia(i, j)));
}

void add_material(XMLElement& visual, const Material& material) {
  if (!material.color) return;
  const Rgba& c = *material.color;
  const std::string color = fmt::format("{} {} {} {}", c[0], c[1], c[2], c[3]);
  XMLElement& element = child(visual, "material");
  child(element, "ambient", color);
  child(element, "diffuse", color);
}

/// SDF's names of shapes are unique within a link.
std::string shape_name(const std::string& given, const std::string& link, const char* what, size_t index) {
  return given.empty() ? fmt::format("{}_{}_{}", link, what, index + 1) : given;
}

class SdfWriter {
 public:
  SdfWriter(const World& world, Warnings& warnings) : world_(world), warnings_(warnings) {}

  std::string text() {
    document_.InsertEndChild(document_.NewDeclaration());
    XMLElement* sdf = document_.NewElement("sdf");
    document_.InsertEndChild(sdf);
    sdf->SetAttribute("version", kVersion);
    XMLElement& model = named(*sdf, "model", world_.name.empty() ? "map" : world_.name);
    for (const Link& link : world_.links) is_frame(link) ? add_frame(model, link) : add_link(model, link);
    for (const Joint& joint : world_.joints) add_joint(model, joint);
    if (!is_frame(*world_.find_link(world_.root))) fix_root(model);
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  /// A link that only gives a place a name. A joint that moves needs a link on both sides, or the world.
  bool is_frame(const Link& link) const {
    if (!link.visuals.empty() || !link.collisions.empty() || link.inertial) return false;
    const Joint* above = world_.parent_joint(link.name);
    if (above == nullptr) return true;
    return above->type == JointType::fixed && std::ranges::none_of(world_.joints, [&](const Joint& joint) {
             return joint.parent == link.name && joint.type != JointType::fixed;
           });
  }

  void add_place(XMLElement& element, const std::string& link) const {
    const Joint* joint = world_.parent_joint(link);
    if (joint == nullptr) return;
    add_pose(element, joint->parent_from_joint).SetAttribute("relative_to", joint->parent.c_str());
  }

  void add_frame(XMLElement& model, const Link& link) const {
    XMLElement& frame = named(model, "frame", link.name);
    const Joint* joint = world_.parent_joint(link.name);
    if (joint != nullptr) frame.SetAttribute("attached_to", joint->parent.c_str());
    add_place(frame, link.name);
  }

  void add_link(XMLElement& model, const Link& link) const {
    XMLElement& element = named(model, "link", link.name);
    add_place(element, link.name);
    if (link.inertial)
      add_inertial(element, *link.inertial);
    else if (link.collisions.empty())
      add_inertial(element,
                   {Isometry3d::Identity(), kFittingMass, kFittingMass * 1e-3 * Eigen::Matrix3d::Identity()});
    for (size_t i = 0; i < link.visuals.size(); ++i) {
      const Visual& visual = link.visuals[i];
      XMLElement& shape = named(element, "visual", shape_name(visual.name, link.name, "visual", i));
      add_pose(shape, visual.link_from_visual);
      add_geometry(shape, visual.geometry);
      if (visual.material) add_material(shape, *visual.material);
    }
    for (size_t i = 0; i < link.collisions.size(); ++i) {
      const Collision& collision = link.collisions[i];
      XMLElement& shape = named(element, "collision", shape_name(collision.name, link.name, "collision", i));
      add_pose(shape, collision.link_from_collision);
      add_geometry(shape, collision.geometry);
    }
  }

  const char* type_of(const Joint& joint) const {
    if (joint.mimic) warnings_.add("SDF has no mimic joints: '" + joint.name + "' moves on its own");
    switch (joint.type) {
      case JointType::revolute:
        return "revolute";
      case JointType::continuous:
        return "continuous";
      case JointType::prismatic:
        return "prismatic";
      case JointType::planar:
        warnings_.add("SDF has no planar joints: '" + joint.name + "' is fixed");
        return "fixed";
      default:
        return "fixed";
    }
  }

  /// The link that a frame belongs to, or the world.
  std::string anchor_of(std::string link) const {
    while (is_frame(*world_.find_link(link))) {
      const Joint* above = world_.parent_joint(link);
      if (above == nullptr) return "world";
      link = above->parent;
    }
    return link;
  }

  void add_joint(XMLElement& model, const Joint& joint) const {
    if (is_frame(*world_.find_link(joint.child)) || joint.type == JointType::floating) return;
    XMLElement& element = named(model, "joint", joint.name);
    const std::string type = type_of(joint);
    element.SetAttribute("type", type.c_str());
    child(element, "parent", anchor_of(joint.parent));
    child(element, "child", joint.child);
    if (type == "fixed") return;
    XMLElement& axis = child(element, "axis");
    child(axis, "xyz", text_of(joint.axis.normalized()));
    if (joint.limits) {
      XMLElement& limit = child(axis, "limit");
      if (joint.type != JointType::continuous) {
        child(limit, "lower", text_of(joint.limits->lower));
        child(limit, "upper", text_of(joint.limits->upper));
      }
      child(limit, "effort", text_of(joint.limits->effort));
      child(limit, "velocity", text_of(joint.limits->velocity));
    }
    if (joint.dynamics) {
      XMLElement& dynamics = child(axis, "dynamics");
      child(dynamics, "damping", text_of(joint.dynamics->damping));
      child(dynamics, "friction", text_of(joint.dynamics->friction));
    }
  }

  void fix_root(XMLElement& model) const {
    XMLElement& joint = named(model, "joint", "world_joint");
    joint.SetAttribute("type", "fixed");
    child(joint, "parent", "world");
    child(joint, "child", world_.root);
  }

  const World& world_;
  Warnings& warnings_;
  tinyxml2::XMLDocument document_;
};

}  // namespace

std::string sdf_text(const World& world, Warnings& warnings) {
  if (world.find_link(world.root) == nullptr) throw Error("the world '" + world.name + "' has no root link");
  return SdfWriter(world, warnings).text();
}

}  // namespace loci::mapping
