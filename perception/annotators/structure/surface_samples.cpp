#include "perception/annotators/structure/surface_samples.h"

#include <Eigen/Geometry>
#include <cmath>

namespace loci::perception {

void add_surface_samples(const mapping::Visual& visual, const mapping::MeshSearch& meshes, double spacing,
                         std::vector<SurfaceSample>& samples) {
  Warnings ignored;  // Missing meshes were warned about when the map was loaded.
  const mapping::TriangleMesh mesh = triangulate(visual.geometry, meshes, ignored);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d origin = visual.link_from_visual * mesh.vertices[a].cast<double>();
    const Vector3d ab = visual.link_from_visual * mesh.vertices[b].cast<double>() - origin;
    const Vector3d ac = visual.link_from_visual * mesh.vertices[c].cast<double>() - origin;
    const Vector3d normal = ab.cross(ac);
    // A grid in the triangle's own coordinates: as dense as the area asks for.
    const int n = static_cast<int>(std::ceil(ab.norm() / spacing));
    const int m = static_cast<int>(std::ceil(ac.norm() / spacing));
    if (!(normal.norm() > 1e-8) || n > 1000 || m > 1000) continue;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        const double s = (i + 0.5) / n, t = (j + 0.5) / m;
        if (s + t < 1) samples.push_back({origin + s * ab + t * ac, normal.normalized()});
      }
  }
}

}  // namespace loci::perception
