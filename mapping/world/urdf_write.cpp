#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>

#include "mapping/base/files.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

using tinyxml2::XMLElement;

/// The shortest text that reads back as the same number.
std::string text_of(double value) {
  return fmt::format("{}", value == 0 ? 0.0 : value);
}
std::string text_of(const Vector3d& v) {
  return text_of(v.x()) + " " + text_of(v.y()) + " " + text_of(v.z());
}

/// Fixed-axis roll, pitch, yaw, exact to rounding also beside pitch = ±90°, where roll and yaw are only
/// determined together: yaw is chosen first and roll is measured in the frame that it leaves.
Vector3d stable_rpy(const Eigen::Matrix3d& r) {
  const double yaw = std::hypot(r(0, 0), r(1, 0)) > 1e-14 ? std::atan2(r(1, 0), r(0, 0)) : 0;
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double pitch = std::atan2(-r(2, 0), c * r(0, 0) + s * r(1, 0));
  const double roll = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return {roll, pitch, yaw};
}

/// An angle to 15 digits: reading 1.57 and writing it again gives 1.57, not 1.5699999999999998.
std::string angle_text(double angle) {
  return std::abs(angle) < 1e-15 ? "0" : fmt::format("{:.15g}", angle);
}

class Writer {
 public:
  explicit Writer(const World& world) : world_(world) {}

  std::string text() {
    document_.InsertEndChild(document_.NewDeclaration(R"(xml version="1.0" encoding="utf-8")"));
    XMLElement* robot = document_.NewElement("robot");
    document_.InsertEndChild(robot);
    robot->SetAttribute("name", world_.name.c_str());
    for (const auto& [name, value] : world_.attributes) robot->SetAttribute(name.c_str(), value.c_str());
    for (const Material& material : world_.materials) add_material(*robot, material);
    for (const Link& link : world_.links) add_link(*robot, link);
    for (const Joint& joint : world_.joints) add_joint(*robot, joint);
    add_extensions(*robot, world_.extensions);
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  static XMLElement& child(XMLElement& parent, const char* name) {
    return *parent.InsertNewChildElement(name);
  }

  static void set(XMLElement& element, const char* attribute, const std::string& value) {
    element.SetAttribute(attribute, value.c_str());
  }

  static void set(XMLElement& element, const char* attribute, double value) {
    if (!std::isfinite(value))
      throw Error(fmt::format("cannot write a URDF with '{}' of <{}> not finite", attribute, element.Name()));
    set(element, attribute, text_of(value));
  }

  static void add_origin(XMLElement& parent, const Isometry3d& pose) {
    if (!pose.matrix().allFinite()) throw Error("cannot write a URDF with a pose that is not finite");
    if (pose.matrix() == Eigen::Matrix4d::Identity()) return;
    XMLElement& origin = child(parent, "origin");
    const Vector3d rpy = stable_rpy(pose.linear());
    set(origin, "xyz", text_of(pose.translation()));
    set(origin, "rpy", angle_text(rpy.x()) + " " + angle_text(rpy.y()) + " " + angle_text(rpy.z()));
  }

  static void add_geometry(XMLElement& parent, const Geometry& geometry) {
    XMLElement& element = child(parent, "geometry");
    if (const Box* box = std::get_if<Box>(&geometry)) {
      set(child(element, "box"), "size", text_of(box->size));
    } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&geometry)) {
      XMLElement& shape = child(element, "cylinder");
      set(shape, "radius", cylinder->radius);
      set(shape, "length", cylinder->length);
    } else if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) {
      set(child(element, "sphere"), "radius", sphere->radius);
    } else {
      const Mesh& mesh = std::get<Mesh>(geometry);
      XMLElement& shape = child(element, "mesh");
      set(shape, "filename", mesh.uri);
      if (mesh.scale != Vector3d::Ones()) set(shape, "scale", text_of(mesh.scale));
    }
  }

  /// A name means one material in the whole file: the first mention defines it, further ones only name it. An
  /// unnamed material is defined where it is used.
  void add_material(XMLElement& parent, const Material& material) {
    XMLElement& element = child(parent, "material");
    set(element, "name", material.name);
    const auto [known, fresh] = materials_.emplace(material.name, material);
    if (!fresh && !material.name.empty()) {
      if (known->second.color != material.color || known->second.texture != material.texture)
        throw Error(
            "the world '" + world_.name + "' has two different materials named '" + material.name + "'", {},
            "in a URDF a material's name means one colour and texture");
      return;
    }
    if (material.color) {
      const Rgba& c = *material.color;
      set(child(element, "color"), "rgba", fmt::format("{} {} {} {}", c[0], c[1], c[2], c[3]));
    }
    if (!material.texture.empty()) set(child(element, "texture"), "filename", material.texture);
  }

  void add_extensions(XMLElement& parent, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      tinyxml2::XMLDocument part;
      if (part.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS)
        throw Error("an extension of the world '" + world_.name + "' is not XML: " + text.substr(0, 60));
      for (const tinyxml2::XMLNode* node = part.FirstChild(); node; node = node->NextSibling())
        parent.InsertEndChild(node->DeepClone(&document_));
    }
  }

  void add_link(XMLElement& robot, const Link& link) {
    XMLElement& element = child(robot, "link");
    set(element, "name", link.name);
    for (const auto& [name, value] : link.attributes) set(element, name.c_str(), value);
    if (link.inertial) add_inertial(element, *link.inertial);
    for (const Visual& visual : link.visuals) {
      XMLElement& shape = child(element, "visual");
      if (!visual.name.empty()) set(shape, "name", visual.name);
      add_origin(shape, visual.link_from_visual);
      add_geometry(shape, visual.geometry);
      if (visual.material) add_material(shape, *visual.material);
      add_extensions(shape, visual.extensions);
    }
    for (const Collision& collision : link.collisions) {
      XMLElement& shape = child(element, "collision");
      if (!collision.name.empty()) set(shape, "name", collision.name);
      add_origin(shape, collision.link_from_collision);
      add_geometry(shape, collision.geometry);
      add_extensions(shape, collision.extensions);
    }
    add_extensions(element, link.extensions);
  }

  static void add_inertial(XMLElement& link, const Inertial& inertial) {
    XMLElement& element = child(link, "inertial");
    add_origin(element, inertial.link_from_inertial);
    set(child(element, "mass"), "value", inertial.mass);
    XMLElement& inertia = child(element, "inertia");
    const Eigen::Matrix3d& m = inertial.inertia;
    set(inertia, "ixx", m(0, 0));
    set(inertia, "ixy", m(0, 1));
    set(inertia, "ixz", m(0, 2));
    set(inertia, "iyy", m(1, 1));
    set(inertia, "iyz", m(1, 2));
    set(inertia, "izz", m(2, 2));
  }

  void add_joint(XMLElement& robot, const Joint& joint) {
    XMLElement& element = child(robot, "joint");
    set(element, "name", joint.name);
    set(element, "type", joint_type_name(joint.type));
    add_origin(element, joint.parent_from_joint);
    set(child(element, "parent"), "link", joint.parent);
    set(child(element, "child"), "link", joint.child);
    if (joint.type != JointType::fixed && joint.type != JointType::floating)
      set(child(element, "axis"), "xyz", text_of(joint.axis));
    add_joint_parameters(element, joint);
    for (const auto& [name, value] : joint.attributes) {
      const size_t slash = name.find('/');
      XMLElement* owner =
          slash == std::string::npos ? &element : element.FirstChildElement(name.substr(0, slash).c_str());
      if (owner) set(*owner, name.substr(slash == std::string::npos ? 0 : slash + 1).c_str(), value);
    }
    add_extensions(element, joint.extensions);
  }

  static void add_joint_parameters(XMLElement& element, const Joint& joint) {
    if (joint.limits) {
      XMLElement& limit = child(element, "limit");
      set(limit, "lower", joint.limits->lower);
      set(limit, "upper", joint.limits->upper);
      set(limit, "effort", joint.limits->effort);
      set(limit, "velocity", joint.limits->velocity);
    }
    if (joint.mimic) {
      XMLElement& mimic = child(element, "mimic");
      set(mimic, "joint", joint.mimic->joint);
      set(mimic, "multiplier", joint.mimic->multiplier);
      set(mimic, "offset", joint.mimic->offset);
    }
    if (joint.safety) {
      XMLElement& safety = child(element, "safety_controller");
      set(safety, "soft_lower_limit", joint.safety->soft_lower);
      set(safety, "soft_upper_limit", joint.safety->soft_upper);
      set(safety, "k_position", joint.safety->k_position);
      set(safety, "k_velocity", joint.safety->k_velocity);
    }
    if (joint.calibration) {
      XMLElement& calibration = child(element, "calibration");
      if (joint.calibration->rising) set(calibration, "rising", *joint.calibration->rising);
      if (joint.calibration->falling) set(calibration, "falling", *joint.calibration->falling);
    }
    if (joint.dynamics) {
      XMLElement& dynamics = child(element, "dynamics");
      set(dynamics, "damping", joint.dynamics->damping);
      set(dynamics, "friction", joint.dynamics->friction);
    }
  }

  const World& world_;
  tinyxml2::XMLDocument document_;
  std::map<std::string, Material> materials_;
};

}  // namespace

std::string urdf_text(const World& world) {
  return Writer(world).text();
}

void write_urdf(const World& world, const std::filesystem::path& path) {
  write_file_atomically(path, urdf_text(world));
}

std::string map_name(const std::filesystem::path& folder) {
  std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const std::string name = path.filename();
  return name.empty() ? "map" : name;
}

}  // namespace loci::mapping
