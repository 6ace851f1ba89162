#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/world/mesh.h"

namespace loci::mapping {
namespace {

TriangleMesh box_triangles(const Box& box) {
  TriangleMesh mesh;
  const Eigen::Vector3f half = (box.size / 2).cast<float>();
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back((corner & 1) ? half.x() : -half.x(), (corner & 2) ? half.y() : -half.y(),
                               (corner & 4) ? half.z() : -half.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Eigen::Vector3f on_circle(double radius, double z, int step, int segments) {
  const double angle = 2 * kPi * step / segments;
  return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>();
}

TriangleMesh cylinder_triangles(const Cylinder& cylinder, int segments) {
  TriangleMesh mesh;
  const double half = cylinder.length / 2;
  for (int i = 0; i < segments; ++i) {
    mesh.vertices.push_back(on_circle(cylinder.radius, -half, i, segments));
    mesh.vertices.push_back(on_circle(cylinder.radius, half, i, segments));
  }
  const uint32_t bottom = static_cast<uint32_t>(mesh.vertices.size()), top = bottom + 1;
  mesh.vertices.emplace_back(0.f, 0.f, static_cast<float>(-half));
  mesh.vertices.emplace_back(0.f, 0.f, static_cast<float>(half));
  for (uint32_t i = 0; i < static_cast<uint32_t>(segments); ++i) {
    const uint32_t low = 2 * i, high = low + 1;
    const uint32_t next_low = 2 * ((i + 1) % static_cast<uint32_t>(segments)), next_high = next_low + 1;
    mesh.triangles.insert(mesh.triangles.end(), {{low, next_low, high},
                                                 {high, next_low, next_high},
                                                 {bottom, next_low, low},
                                                 {top, high, next_high}});
  }
  return mesh;
}

/// Rings of latitude between two poles, all vertices on the sphere.
TriangleMesh sphere_triangles(const Sphere& sphere, int segments) {
  TriangleMesh mesh;
  const int rings = segments / 2;
  const uint32_t around = static_cast<uint32_t>(segments);
  for (int ring = 1; ring < rings; ++ring) {
    const double polar = kPi * ring / rings;
    for (int i = 0; i < segments; ++i)
      mesh.vertices.push_back(
          on_circle(sphere.radius * std::sin(polar), -sphere.radius * std::cos(polar), i, segments));
  }
  const uint32_t south = static_cast<uint32_t>(mesh.vertices.size()), north = south + 1;
  mesh.vertices.emplace_back(0.f, 0.f, static_cast<float>(-sphere.radius));
  mesh.vertices.emplace_back(0.f, 0.f, static_cast<float>(sphere.radius));
  const uint32_t last_ring = (static_cast<uint32_t>(rings) - 2) * around;
  for (uint32_t i = 0; i < around; ++i) {
    const uint32_t next = (i + 1) % around;
    mesh.triangles.push_back({south, next, i});
    for (uint32_t ring = 0; ring < last_ring; ring += around) {
      mesh.triangles.push_back({ring + i, ring + next, ring + around + i});
      mesh.triangles.push_back({ring + around + i, ring + next, ring + around + next});
    }
    mesh.triangles.push_back({north, last_ring + i, last_ring + next});
  }
  return mesh;
}

}  // namespace

TriangleMesh triangulate(const Geometry& geometry, const MeshSearch& search, Warnings& warnings,
                         int segments) {
  segments = std::max(segments, 4) / 2 * 2;
  if (const Box* box = std::get_if<Box>(&geometry)) return box_triangles(*box);
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&geometry))
    return cylinder_triangles(*cylinder, segments);
  if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) return sphere_triangles(*sphere, segments);
  return load_mesh(std::get<Mesh>(geometry), search, warnings);
}

}  // namespace loci::mapping
