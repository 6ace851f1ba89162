#include "mapping/exchange/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

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

}  // namespace

std::string ply_text(const std::vector<WorldTriangle>& triangles) {
  std::string bytes =
      header(fmt::format("element vertex {}\n{}{}element face {}\nproperty list uchar int vertex_indices\n",
                         3 * triangles.size(), kPosition, kColor, triangles.size()));
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
