#include "mapping/render/surface.h"

#include <algorithm>
#include <limits>
#include <span>

namespace loci::mapping::render_detail {
namespace {

using Eigen::Vector3f;

/// The mesh in the link's frame while it is being cut.
struct Cutter {
  const TriangleMesh& mesh;
  const std::vector<std::array<uint8_t, 3>>& colors;
  std::vector<Vector3f> vertices;   ///< link frame
  std::vector<Vector3f> centroids;  ///< by triangle, times three
  std::vector<uint32_t> local;      ///< by vertex: its number in the current cluster
  std::vector<std::shared_ptr<const Surface>> surfaces;

  static constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();

  Eigen::AlignedBox3f box_of(std::span<const uint32_t> triangles) const {
    Eigen::AlignedBox3f box;
    for (const uint32_t triangle : triangles)
      for (const uint32_t vertex : mesh.triangles[triangle]) box.extend(vertices[vertex]);
    return box;
  }

  /// Halves at a multiple of a cluster, so that clusters are full.
  size_t halve(std::span<uint32_t> triangles) const {
    Eigen::AlignedBox3f box;
    for (const uint32_t triangle : triangles) box.extend(centroids[triangle]);
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const size_t clusters = (triangles.size() + Cluster::kTriangles - 1) / Cluster::kTriangles;
    const size_t middle = clusters / 2 * Cluster::kTriangles;
    const auto before = [&](uint32_t a, uint32_t b) {
      const float at_a = centroids[a][axis], at_b = centroids[b][axis];
      return at_a < at_b || (at_a == at_b && a < b);
    };
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<ptrdiff_t>(middle), triangles.end(),
                     before);
    return middle;
  }

  void cut(std::span<uint32_t> triangles) {
    if (triangles.size() > Surface::kTriangles) {
      const size_t middle = halve(triangles);
      cut(triangles.first(middle));
      cut(triangles.subspan(middle));
      return;
    }
    auto surface = std::make_shared<Surface>();
    const Eigen::AlignedBox3d box = box_of(triangles).cast<double>();
    surface->centre = box.center();
    surface->half = box.sizes() / 2;
    if (colors.size() == 1) surface->colors = colors;
    add_clusters(triangles, *surface);
    surfaces.push_back(std::move(surface));
  }

  void add_clusters(std::span<uint32_t> triangles, Surface& surface) {
    if (triangles.size() > Cluster::kTriangles) {
      const size_t middle = halve(triangles);
      add_clusters(triangles.first(middle), surface);
      add_clusters(triangles.subspan(middle), surface);
      return;
    }
    std::ranges::sort(triangles);
    const Eigen::AlignedBox3d box = box_of(triangles).cast<double>();
    Cluster cluster{box.center(),
                    box.sizes() / 2,
                    static_cast<uint32_t>(surface.x.size()),
                    0,
                    static_cast<uint32_t>(surface.triangles.size()),
                    static_cast<uint32_t>(triangles.size())};
    for (const uint32_t triangle : triangles) {
      std::array<uint8_t, 3>& corners = surface.triangles.emplace_back();
      for (size_t k = 0; k < 3; ++k) corners[k] = corner(mesh.triangles[triangle][k], cluster, surface);
      if (colors.size() != 1) surface.colors.push_back(colors[triangle]);
    }
    for (const uint32_t triangle : triangles)
      for (const uint32_t vertex : mesh.triangles[triangle]) local[vertex] = kUnused;
    surface.clusters.push_back(cluster);
  }

  uint8_t corner(uint32_t vertex, Cluster& cluster, Surface& surface) {
    if (local[vertex] == kUnused) {
      local[vertex] = cluster.vertices++;
      surface.x.push_back(vertices[vertex].x());
      surface.y.push_back(vertices[vertex].y());
      surface.z.push_back(vertices[vertex].z());
    }
    return static_cast<uint8_t>(local[vertex]);
  }
};

}  // namespace

Eigen::Vector3d Surface::normal(uint32_t triangle) const {
  const Cluster& cluster =
      *std::prev(std::ranges::upper_bound(clusters, triangle, {}, &Cluster::first_triangle));
  Eigen::Vector3d corners[3];
  for (size_t k = 0; k < 3; ++k) {
    const size_t i = cluster.first_vertex + triangles[triangle][k];
    corners[k] = Vector3f(x[i], y[i], z[i]).cast<double>();
  }
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
}

std::vector<std::shared_ptr<const Surface>> cut_mesh(const TriangleMesh& mesh,
                                                     const Isometry3d& link_from_mesh,
                                                     const std::vector<std::array<uint8_t, 3>>& colors) {
  Cutter cutter{mesh, colors, {}, {}, std::vector<uint32_t>(mesh.vertices.size(), Cutter::kUnused), {}};
  for (const Vector3f& vertex : mesh.vertices)
    cutter.vertices.push_back((link_from_mesh * vertex.cast<double>()).cast<float>());
  std::vector<uint32_t> triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    cutter.centroids.push_back(cutter.vertices[a] + cutter.vertices[b] + cutter.vertices[c]);
    if (cutter.centroids.back().allFinite())
      triangles.push_back(static_cast<uint32_t>(cutter.centroids.size() - 1));
  }
  if (!triangles.empty()) cutter.cut(triangles);
  return std::move(cutter.surfaces);
}

}  // namespace loci::mapping::render_detail
