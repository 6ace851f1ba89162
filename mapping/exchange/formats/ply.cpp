#include "mapping/exchange/formats/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "mapping/base/files.h"

namespace loci::mapping {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written as it lies in memory");

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_position(std::string& bytes, const Vector3d& position) {
  for (const int axis : {0, 1, 2}) put(bytes, static_cast<float>(position[axis]));
}

uint8_t channel(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 255));
}

constexpr const char* kPosition = "property float x\nproperty float y\nproperty float z\n";
constexpr const char* kColor = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

std::string header(const std::string& elements) {
  return "ply\nformat binary_little_endian 1.0\ncomment map frame, metres\n" + elements + "end_header\n";
}

std::string mesh_header(size_t vertices, size_t triangles) {
  return header(
      fmt::format("element vertex {}\n{}{}element face {}\nproperty list uchar int vertex_indices\n",
                  vertices, kPosition, kColor, triangles));
}

}  // namespace

std::string ply_text(const ColoredMesh& mesh) {
  std::string bytes = mesh_header(mesh.positions.size(), mesh.triangles.size());
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const int axis : {0, 1, 2}) put(bytes, mesh.positions[i][axis]);
    for (const uint8_t channel : mesh.colors[i]) put(bytes, channel);
  }
  for (const auto& triangle : mesh.triangles) {
    put(bytes, uint8_t{3});
    for (const uint32_t corner : triangle) put(bytes, static_cast<int32_t>(corner));
  }
  return bytes;
}

ColoredMesh read_ply_mesh(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const Error other("this is not a mesh that loci-map fuse made", {path.string(), 0, {}},
                    "give its room.ply");
  const auto count_of = [&](const std::string& element) -> size_t {
    const size_t at = bytes.find("element " + element + " ");
    size_t count = 0;
    const char* begin = bytes.data() + at + element.size() + 9;
    if (at == std::string::npos || at > 1000 ||
        std::from_chars(begin, bytes.data() + bytes.size(), count).ec != std::errc())
      throw other;
    return count;
  };
  const size_t vertices = count_of("vertex"), triangles = count_of("face");
  const std::string head = mesh_header(vertices, triangles);
  constexpr size_t kVertex = 15, kTriangle = 13;  // bytes
  if (!bytes.starts_with(head) || vertices > bytes.size() / kVertex || triangles > bytes.size() / kTriangle ||
      bytes.size() != head.size() + kVertex * vertices + kTriangle * triangles)
    throw other;
  const char* at = bytes.data() + head.size();
  const auto take = [&](void* value, size_t size) {
    std::memcpy(value, at, size);
    at += size;
  };
  ColoredMesh mesh;
  mesh.positions.resize(vertices);
  mesh.colors.resize(vertices);
  mesh.triangles.resize(triangles);
  for (size_t i = 0; i < vertices; ++i) {
    take(mesh.positions[i].data(), 12);
    take(mesh.colors[i].data(), 3);
    if (!mesh.positions[i].allFinite()) throw other;
  }
  for (auto& triangle : mesh.triangles) {
    uint8_t corners = 0;
    take(&corners, 1);
    take(triangle.data(), 12);
    if (corners != 3 || *std::ranges::max_element(triangle) >= vertices) throw other;
  }
  return mesh;
}

std::string ply_text(const std::vector<WorldTriangle>& triangles) {
  std::string bytes = mesh_header(3 * triangles.size(), triangles.size());
  for (const WorldTriangle& triangle : triangles)
    for (const Vector3d& corner : triangle.corners) {
      put_position(bytes, corner);
      for (const int i : {0, 1, 2}) put(bytes, channel(triangle.color[i]));
    }
  for (size_t i = 0; i < triangles.size(); ++i) {
    put(bytes, uint8_t{3});
    for (size_t k = 0; k < 3; ++k) put(bytes, static_cast<int32_t>(3 * i + k));
  }
  return bytes;
}

std::string ply_text(const ScanSet& scans) {
  size_t count = 0;
  for (const Scan& scan : scans.scans)
    count += static_cast<size_t>(std::ranges::count_if(scan.points, &ScanPoint::returned));
  std::string bytes =
      header(fmt::format("element vertex {}\n{}property float intensity\n{}", count, kPosition, kColor));
  for (const Scan& scan : scans.scans)
    for (const ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      put_position(bytes, scan.map_from_scan * point.position.cast<double>());
      put(bytes, point.intensity);
      for (const uint8_t value : {point.r, point.g, point.b}) put(bytes, value);
    }
  return bytes;
}

}  // namespace loci::mapping
