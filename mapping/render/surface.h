#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/world/mesh.h"

namespace loci::mapping::render_detail {

/// Triangles that lie together: few enough that their corners fit the cache and a byte numbers them.
struct Cluster {
  static constexpr size_t kTriangles = 64;
  static constexpr size_t kVertices = 3 * kTriangles;

  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), half = Eigen::Vector3d::Zero();  ///< of its box
  uint32_t first_vertex = 0, vertices = 0;
  uint32_t first_triangle = 0, triangles = 0;
};

/// A piece of a link's surface, in the link's frame, metres. Many instances may share it.
struct Surface {
  static constexpr size_t kTriangles = 8192;

  std::vector<float> x, y, z;                     ///< vertices, cluster after cluster
  std::vector<std::array<uint8_t, 3>> triangles;  ///< corners, counted within the cluster
  std::vector<std::array<uint8_t, 3>> colors;     ///< RGB, one for all or one per triangle
  std::vector<Cluster> clusters;                  ///< neighbours in the list are neighbours in space
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), half = Eigen::Vector3d::Zero();  ///< of its box

  /// Unit normal of a triangle.
  Eigen::Vector3d normal(uint32_t triangle) const;
};

/// Cuts a mesh into surfaces of clusters by halving it along the longest side until the pieces are small.
/// Triangles with a corner that is no number are left out.
std::vector<std::shared_ptr<const Surface>> cut_mesh(const TriangleMesh& mesh,
                                                     const Isometry3d& link_from_mesh,
                                                     const std::vector<std::array<uint8_t, 3>>& colors);

}  // namespace loci::mapping::render_detail
