#include "mapping/exchange/formats/mjcf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <map>

namespace loci::mapping {
namespace {

using tinyxml2::XMLElement;

constexpr double kMinMass = 1e-3;     // kg; MuJoCo refuses to move what has none
constexpr double kMinInertia = 1e-6;  // kg m²
constexpr double kMinVolume = 1e-9;   // m³; MuJoCo refuses flat meshes
constexpr double kMinSide = 1e-4;     // m, of the box in place of a flat mesh

std::string numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::vector<double> numbers;
  for (const double value : values) numbers.push_back(value == 0 ? 0.0 : value);
  return fmt::format("{}", fmt::join(numbers, " "));
}

XMLElement& add_child(XMLElement& parent, const char* name) {
  return *parent.InsertNewChildElement(name);
}

void set(XMLElement& element, const char* attribute, const std::string& value) {
  element.SetAttribute(attribute, value.c_str());
}

void set_pose(XMLElement& element, const Isometry3d& pose) {
  set(element, "pos", numbers(pose.translation()));
  const Eigen::Quaterniond q(pose.linear());
  set(element, "quat", numbers(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())));
}

/// Of the tetrahedra between the triangles and a vertex, each counted as positive, as MuJoCo does.
double mesh_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f origin = mesh.vertices[0];
    const Eigen::Vector3f u = mesh.vertices[a] - origin, v = mesh.vertices[b] - origin;
    volume += std::abs(static_cast<double>(u.cross(v).dot(mesh.vertices[c] - origin))) / 6;
  }
  return volume;
}

class MjcfWriter {
 public:
  MjcfWriter(const World& world, const MeshSearch& search, Warnings& warnings)
      : world_(world), search_(search), warnings_(warnings) {
    for (const Joint& joint : world.joints) joints_below_[joint.parent].push_back(&joint);
  }

  std::string text() {
    XMLElement* root = document_.NewElement("mujoco");
    document_.InsertEndChild(root);
    set(*root, "model", world_.name.empty() ? "map" : world_.name);
    XMLElement& compiler = add_child(*root, "compiler");
    set(compiler, "angle", "radian");
    set(compiler, "balanceinertia", "true");
    compiler.SetAttribute("boundmass", kMinMass);
    compiler.SetAttribute("boundinertia", kMinInertia);
    assets_ = &add_child(*root, "asset");
    XMLElement& bodies = add_child(*root, "worldbody");
    equalities_ = &add_child(*root, "equality");
    motors_ = &add_child(*root, "actuator");
    add_body(bodies, *world_.find_link(world_.root), nullptr);
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  void add_body(XMLElement& parent, const Link& link, const Joint* above) {
    // "world" is the name of MuJoCo's own root.
    const bool is_world = above == nullptr && link.name == "world";
    XMLElement& body = is_world ? parent : add_child(parent, "body");
    if (!is_world) set(body, "name", link.name == "world" ? "world_link" : link.name);
    if (above != nullptr) {
      set_pose(body, above->parent_from_joint);
      add_joint(body, *above);
    }
    if (!is_world && link.inertial && link.inertial->mass > 0) add_inertial(body, *link.inertial);
    for (const Visual& visual : link.visuals) {
      XMLElement& geom = add_geom(body, visual.link_from_visual, visual.geometry);
      for (const char* none : {"contype", "conaffinity", "mass"}) geom.SetAttribute(none, 0);
      geom.SetAttribute("group", 2);
      if (visual.material && visual.material->color)
        set(geom, "rgba", numbers(visual.material->color->cast<double>()));
    }
    for (const Collision& collision : link.collisions)
      add_geom(body, collision.link_from_collision, collision.geometry).SetAttribute("group", 3);
    for (const Joint* joint : joints_below_[link.name])
      add_body(body, *world_.find_link(joint->child), joint);
  }

  void add_joint(XMLElement& body, const Joint& joint) {
    if (joint.type == JointType::fixed) return;
    if (joint.type == JointType::floating || joint.type == JointType::planar) {
      warnings_.add(
          fmt::format("'{}' is fixed in MJCF: it is a {} joint", joint.name, joint_type_name(joint.type)));
      return;
    }
    XMLElement& element = add_child(body, "joint");
    set(element, "name", joint.name);
    set(element, "type", joint.type == JointType::prismatic ? "slide" : "hinge");
    set(element, "axis", numbers(joint.axis.normalized()));
    if (joint.limits && joint.type != JointType::continuous) {
      set(element, "limited", "true");
      set(element, "range", numbers(Eigen::Vector2d(joint.limits->lower, joint.limits->upper)));
    }
    if (joint.dynamics) {
      element.SetAttribute("damping", joint.dynamics->damping);
      element.SetAttribute("frictionloss", joint.dynamics->friction);
    }
    if (joint.mimic) {
      XMLElement& equality = add_child(*equalities_, "joint");
      set(equality, "joint1", joint.name);
      set(equality, "joint2", joint.mimic->joint);
      set(equality, "polycoef",
          numbers(Eigen::Matrix<double, 5, 1>(joint.mimic->offset, joint.mimic->multiplier, 0, 0, 0)));
    }
    XMLElement& motor = add_child(*motors_, "motor");
    set(motor, "name", joint.name);
    set(motor, "joint", joint.name);
    if (!joint.limits || !(joint.limits->effort > 0)) return;
    set(motor, "ctrllimited", "true");
    set(motor, "ctrlrange", numbers(Eigen::Vector2d(-joint.limits->effort, joint.limits->effort)));
  }

  static void add_inertial(XMLElement& body, const Inertial& inertial) {
    XMLElement& element = add_child(body, "inertial");
    set(element, "pos", numbers(inertial.link_from_inertial.translation()));
    element.SetAttribute("mass", inertial.mass);
    const Eigen::Matrix3d turn = inertial.link_from_inertial.linear();
    const Eigen::Matrix3d i = turn * inertial.inertia * turn.transpose();
    set(element, "fullinertia",
        numbers(Eigen::Matrix<double, 6, 1>(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2))));
  }

  XMLElement& add_geom(XMLElement& body, const Isometry3d& pose, const Geometry& geometry) {
    XMLElement& geom = add_child(body, "geom");
    set_pose(geom, pose);
    const auto describe = [&](const char* type, const Eigen::Ref<const Eigen::VectorXd>& size) {
      set(geom, "type", type);
      set(geom, "size", numbers(size));
    };
    if (const auto* box = std::get_if<Box>(&geometry)) {
      describe("box", box->size / 2);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
      describe("cylinder", Eigen::Vector2d(cylinder->radius, cylinder->length / 2));
    } else if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
      describe("sphere", Eigen::Matrix<double, 1, 1>(sphere->radius));
    } else {
      add_mesh(geom, pose, geometry);
    }
    return geom;
  }

  void add_mesh(XMLElement& geom, const Isometry3d& pose, const Geometry& geometry) {
    const TriangleMesh mesh = triangulate(geometry, search_, warnings_);
    if (!mesh.colors.empty()) set(geom, "rgba", numbers(mesh.colors.front().cast<double>()));
    Eigen::AlignedBox3f bounds;
    for (const Eigen::Vector3f& vertex : mesh.vertices) bounds.extend(vertex);
    if (mesh.vertices.empty() || mesh_volume(mesh) < kMinVolume) {
      if (mesh.vertices.empty()) bounds.extend(Eigen::Vector3f(0, 0, 0));
      set_pose(geom, pose * Eigen::Translation3d(bounds.center().cast<double>()));
      set(geom, "type", "box");
      set(geom, "size", numbers((bounds.sizes().cast<double>() / 2).cwiseMax(kMinSide)));
      return;
    }
    set(geom, "type", "mesh");
    set(geom, "mesh", asset_of(mesh));
  }

  /// The name of a mesh's asset; equal meshes are one.
  std::string asset_of(const TriangleMesh& mesh) {
    std::string vertices, faces;
    for (const Eigen::Vector3f& v : mesh.vertices) vertices += fmt::format("{} {} {} ", v.x(), v.y(), v.z());
    for (const auto& [a, b, c] : mesh.triangles) faces += fmt::format("{} {} {} ", a, b, c);
    const auto [entry, fresh] = meshes_.emplace(vertices + faces, fmt::format("mesh_{}", meshes_.size() + 1));
    if (fresh) {
      XMLElement& asset = add_child(*assets_, "mesh");
      set(asset, "name", entry->second);
      set(asset, "vertex", vertices);
      set(asset, "face", faces);
    }
    return entry->second;
  }

  const World& world_;
  const MeshSearch& search_;
  Warnings& warnings_;
  std::map<std::string, std::vector<const Joint*>> joints_below_;
  std::map<std::string, std::string> meshes_;
  tinyxml2::XMLDocument document_;
  XMLElement* assets_ = nullptr;
  XMLElement* equalities_ = nullptr;
  XMLElement* motors_ = nullptr;
};

}  // namespace

std::string mjcf_text(const World& world, const MeshSearch& search, Warnings& warnings) {
  if (world.find_link(world.root) == nullptr) throw Error("the world '" + world.name + "' has no root link");
  return MjcfWriter(world, search, warnings).text();
}

}  // namespace loci::mapping
