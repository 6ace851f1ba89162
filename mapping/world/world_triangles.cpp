#include "mapping/world/world_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/world/kinematics.h"

namespace loci::mapping {

std::vector<WorldTriangle> triangles_of(const World& world, const MeshSearch& search, Warnings& warnings) {
  constexpr double kSliver = 1e-8;  // m²
  const std::vector<Isometry3d> root_from_link = root_from_links(world, {});
  std::vector<WorldTriangle> triangles;
  for (size_t i = 0; i < world.links.size(); ++i)
    for (const Visual& visual : world.links[i].visuals) {
      const Isometry3d root_from_visual = root_from_link[i] * visual.link_from_visual;
      const TriangleMesh mesh = triangulate(visual.geometry, search, warnings);
      for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        WorldTriangle triangle;
        for (size_t k = 0; k < 3; ++k)
          triangle.corners[k] = root_from_visual * mesh.vertices[mesh.triangles[t][k]].cast<double>();
        const Vector3d cross =
            (triangle.corners[1] - triangle.corners[0]).cross(triangle.corners[2] - triangle.corners[0]);
        triangle.area = cross.norm() / 2;
        if (triangle.area < kSliver) continue;
        triangle.normal = cross.normalized();
        triangle.link = i;
        // A URDF material says more than the mesh file, as in RViz.
        if (visual.material && visual.material->color)
          triangle.color = *visual.material->color;
        else if (!mesh.colors.empty())
          triangle.color = mesh.colors[t];
        triangles.push_back(triangle);
      }
    }
  return triangles;
}

std::optional<double> floor_height(const World& world, const std::vector<WorldTriangle>& triangles) {
  constexpr double kLevel = 0.99;       // z of the normal
  constexpr double kStep = 0.01;        // m, between two levels
  constexpr double kGroundShare = 0.5;  // of the ground plan; furniture leaves room to walk
  const bool named = world.find_link("floor") != nullptr;
  const size_t floor = named ? world.link_index("floor") : 0;
  Eigen::AlignedBox2d plan;
  struct Level {
    double area = 0, weighted = 0;
    double height() const { return weighted / area; }
  };
  std::map<long, Level> levels;
  for (const WorldTriangle& triangle : triangles) {
    for (const Vector3d& corner : triangle.corners) plan.extend(corner.head<2>());
    if (triangle.normal.z() > kLevel && (!named || triangle.link == floor)) {
      Level& level = levels[std::lround(triangle.corners[0].z() / kStep)];
      level.area += triangle.area;
      level.weighted += triangle.area * triangle.corners[0].z();
    }
  }
  if (levels.empty()) return std::nullopt;
  if (named)
    return std::ranges::max_element(levels, {}, [](const auto& at) { return at.second.area; })
        ->second.height();
  for (const auto& [number, level] : levels)
    if (level.area > kGroundShare * plan.volume()) return level.height();
  return std::nullopt;
}

bool is_at_zero(double floor_height) {
  return std::abs(floor_height) < 0.05;
}

}  // namespace loci::mapping
