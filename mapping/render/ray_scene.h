#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh.h"

namespace loci {

/// Where a ray met a surface.
struct RayHit {
  float distance = 0;                                ///< metres along the ray; infinity = nothing
  int link = -1;                                     ///< index into RayScene::link_names(), -1 = nothing
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, map frame, towards the ray's origin
  std::array<uint8_t, 3> color{};                    ///< red, green, blue of the material
};

/// Worlds for ray casting (Embree): for lasers, and to check the rasteriser. Its sibling for whole pictures
/// is RenderScene; parts, joints and names work alike.
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

  /// Casts a ray; `direction` is a unit vector. Safe to call from several threads at once.
  RayHit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float range_max) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci
