#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::mapping {

struct Box {
  Vector3d size = Vector3d::Zero();  ///< full extents, metres
};
struct Cylinder {  ///< axis along z, centred
  double radius = 0;
  double length = 0;
};
struct Sphere {
  double radius = 0;
};
/// Triangles from a file, which load_mesh() reads.
struct Mesh {
  std::string uri;  ///< as in the URDF ("package://…", "file://…", or relative)
  Vector3d scale = Vector3d::Ones();
};
using Geometry = std::variant<Box, Cylinder, Sphere, Mesh>;

/// Red, green, blue, alpha in [0,1].
using Rgba = Eigen::Vector4f;

struct Material {
  std::string name;
  std::optional<Rgba> color;
  std::string texture;  ///< file as in the URDF; empty = none
};

struct Visual {
  std::string name;
  Isometry3d link_from_visual = Isometry3d::Identity();
  Geometry geometry;
  std::optional<Material> material;
  std::vector<std::string> extensions = {};  ///< elements that URDF does not define, as XML text
};

struct Collision {
  std::string name;
  Isometry3d link_from_collision = Isometry3d::Identity();
  Geometry geometry;
  std::vector<std::string> extensions = {};  ///< as in Visual
};

struct Inertial {
  Isometry3d link_from_inertial = Isometry3d::Identity();
  double mass = 0;                                    ///< kg
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< kg m², in the inertial frame
};

struct Link {
  std::string name;
  std::vector<Visual> visuals;
  std::vector<Collision> collisions;
  std::optional<Inertial> inertial;
  std::map<std::string, std::string> attributes = {};  ///< other than the name
  std::vector<std::string> extensions = {};            ///< elements that URDF does not define, as XML text
};

enum class JointType { fixed, revolute, continuous, prismatic, floating, planar };

struct JointLimits {
  double lower = 0, upper = 0, effort = 0, velocity = 0;
};
struct JointMimic {
  std::string joint;
  double multiplier = 1, offset = 0;
};
struct JointSafety {
  double soft_lower = 0, soft_upper = 0, k_position = 0, k_velocity = 0;
};
struct JointCalibration {
  std::optional<double> rising, falling;
};
struct JointDynamics {
  double damping = 0, friction = 0;
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  std::string parent;  ///< link
  std::string child;   ///< link
  Isometry3d parent_from_joint = Isometry3d::Identity();
  Vector3d axis = Vector3d::UnitX();  ///< in the joint frame
  std::optional<JointLimits> limits;
  std::optional<JointMimic> mimic;
  std::optional<JointSafety> safety;
  std::optional<JointCalibration> calibration;
  std::optional<JointDynamics> dynamics;
  /// Attributes that URDF does not define, by "ATTRIBUTE" or "ELEMENT/ATTRIBUTE"
  /// ("limit/drake:acceleration").
  std::map<std::string, std::string> attributes = {};
  std::vector<std::string> extensions = {};  ///< elements that URDF does not define, as XML text
};

/// A URDF model as plain values: the map, a robot, or a piece of furniture. A joint state is apart from it.
struct World {
  std::string name;
  std::vector<Link> links;    ///< in the order of the file
  std::vector<Joint> joints;  ///< in the order of the file
  std::string root;           ///< the one link that is no joint's child
  /// Declared at the top of the file, used or not. A visual carries its own copy of what it uses; one name
  /// means one material in the whole file.
  std::vector<Material> materials;
  /// Attributes of the robot element other than its name (namespaces, version).
  std::map<std::string, std::string> attributes;
  /// Elements that URDF does not define or that say nothing about geometry (gazebo, transmission, sensor, …):
  /// kept as XML text and written back.
  std::vector<std::string> extensions;

  const Link* find_link(const std::string& link_name) const;
  const Joint* find_joint(const std::string& joint_name) const;
  /// Index into links; Error naming the closest link when there is none.
  size_t link_index(const std::string& link_name) const;
  /// The joint whose child is this link; nullptr for the root.
  const Joint* parent_joint(const std::string& link_name) const;
};

const char* joint_type_name(JointType type);

}  // namespace loci::mapping
