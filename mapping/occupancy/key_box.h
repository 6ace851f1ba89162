#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace loci::mapping::occupancy {

constexpr int kBrick = 8;       ///< cells along a brick's edge
constexpr uint8_t kPassed = 1;  ///< a ray passed through the cell
constexpr uint8_t kHit = 2;     ///< a ray ended in the cell

/// A box of OctoMap keys, aligned to bricks of 8 × 8 × 8 cells; a cell's address counts x fastest.
struct KeyBox {
  Eigen::Vector3i low = Eigen::Vector3i::Zero();   ///< first key
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  ///< cells, multiples of 8

  size_t cells() const {
    return static_cast<size_t>(size.x()) * static_cast<size_t>(size.y()) * static_cast<size_t>(size.z());
  }
  Eigen::Vector3i strides() const { return {1, size.x(), size.x() * size.y()}; }
  int32_t address(const octomap::OcTreeKey& key) const {
    return (key[0] - low.x()) + size.x() * ((key[1] - low.y()) + size.y() * (key[2] - low.z()));
  }
};

}  // namespace loci::mapping::occupancy
