#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh.h"

namespace loci::mapping {

/// Where a ray met a surface.
struct RayHit {
  float distance = 0;                                ///< metres along the ray; infinity = nothing
  int link = -1;                                     ///< index into RayScene::link_names(), -1 = nothing
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, map frame, towards the ray's origin
  std::array<uint8_t, 3> color{};                    ///< red, green, blue of the material
  bool from_behind = false;                          ///< the side of the triangle that is inside was met
  bool glossy = false;                               ///< mirrors rather than scatters, see glossy_material()
};

/// The surface point that is nearest to another point.
struct NearestSurface {
  int link = -1;  ///< index into RayScene::link_names(), -1 = nothing within reach
  double distance = 0;
  Vector3d point = Vector3d::Zero();  ///< map frame
};

/// URDF cannot say that a material is shiny, so its name does: one that contains "glossy", "glass", "mirror"
/// or "chrome" (in any case) is.
bool glossy_material(const std::string& name);

/// Worlds for ray casting (Embree): for lasers, and to check the rasteriser. Its sibling for whole images
/// is RenderScene; parts, joints and names work alike. Links that no joint moves against each other share one
/// search tree, so that moving a joint costs microseconds, whatever it carries.
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  size_t add(const World& world, const MeshSearch& search, const Isometry3d& map_from_root,
             Warnings& warnings);
  size_t add(const std::string& name, const TriangleMesh& mesh, const Isometry3d& map_from_mesh);
  void set_joints(size_t part, const JointState& state);
  const std::vector<std::string>& link_names() const;
  Isometry3d map_from_link(size_t link) const;
  /// Of all that was added, map frame; may be empty.
  Eigen::AlignedBox3d bounds() const;

  /// Casts a ray; `direction` is a unit vector. Safe to call from several threads at once.
  RayHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float range_max) const;

  /// A link whose surface reaches into an upright cylinder, or a small closed body (less than a metre to its
  /// sides) that the cylinder's middle lies in; -1 = none. Looks at every triangle: for now and then.
  int link_in_cylinder(const Vector2d& centre, double radius, double z_min, double z_max) const;
  /// The surface that is nearest to a point, within `radius`. Looks at every triangle, too.
  NearestSurface nearest(const Vector3d& point, double radius) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::mapping
