#include "mapping/exchange/world_triangles.h"

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

}  // namespace loci::mapping
