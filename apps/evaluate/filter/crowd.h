#pragma once

#include <filesystem>
#include <vector>

#include "mapping/base/random.h"
#include "mapping/sensor/camera.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::apps::filter_evaluation {

constexpr int kMeshVertices = 3500;  ///< of each mesh, as in §4.2.2.2
constexpr int kDistinctMeshes = 50;
constexpr int kRobotMeshes = 45;

/// Closed bodies of kMeshVertices vertices between ellipsoid and box with waves on them, half as long as
/// [least, most] along each axis: the sizes of a robot's links.
mapping::TriangleMesh random_body(double min_half_m, double max_half_m, Random& random);

/// A pose at a random orientation whose origin is in the image, 1 to 6 m away, uniform in depth.
Isometry3d random_pose_in_view(const mapping::PinholeCamera& camera, Random& random);

/// A robot of 45 links with a mesh each, four arms of revolute joints on a base; meshes are written into a
/// folder, which the URDF's relative names refer to.
mapping::World random_robot(const std::filesystem::path& folder, Random& random);

/// A joint state of it.
JointState random_joints(const mapping::World& robot, Random& random);

}  // namespace loci::apps::filter_evaluation
