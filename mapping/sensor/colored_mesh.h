#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace loci::mapping {

/// A surface of triangles with a colour at each vertex.
struct ColoredMesh {
  std::vector<Eigen::Vector3f> positions;          ///< metres
  std::vector<std::array<uint8_t, 3>> colors;      ///< red, green, blue; one per position
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
};

}  // namespace loci::mapping
