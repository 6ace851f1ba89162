#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mapping/base/math/moments.h"
#include "mapping/base/math/pose.h"

namespace loci::mapping::registration {

/// Numbers of the cells of a bounded grid for fast look-ups: blocks of 4x4x4 cells behind a dense directory,
/// so that a look-up is two loads without hashing. (mapping/base/cell_index is for unbounded grids.)
class CellGrid {
 public:
  static constexpr uint32_t kNone = UINT32_MAX;

  CellGrid() = default;
  /// For cells from `low` to `high`, both included. A grid of more than kSurfels.max_blocks is cropped
  /// around `centre`.
  CellGrid(const Eigen::Vector3i& low, const Eigen::Vector3i& high, const Eigen::Vector3i& centre);

  bool covers(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i at = block_of(cell);
    return (at.array() >= 0).all() && (at.array() < size_.array()).all();
  }

  uint32_t find(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i at = block_of(cell);
    if (static_cast<uint32_t>(at.x()) >= static_cast<uint32_t>(size_.x()) ||
        static_cast<uint32_t>(at.y()) >= static_cast<uint32_t>(size_.y()) ||
        static_cast<uint32_t>(at.z()) >= static_cast<uint32_t>(size_.z()))
      return kNone;
    return blocks_[directory_[directory_index(at)]][slot_of(cell)];
  }

  /// Numbers of the 2x2x2 cells from `corner` on, x fastest.
  std::array<uint32_t, 8> find_eight(const Eigen::Vector3i& corner) const {
    std::array<uint32_t, 8> found;
    const Eigen::Vector3i at = block_of(corner);
    if ((at.array() < 0).any() || (at.array() + 1 >= size_.array()).any()) {  // At the border: one by one.
      for (int k = 0; k < 8; ++k)
        found[static_cast<size_t>(k)] = find(corner + Eigen::Vector3i(k & 1, k >> 1 & 1, k >> 2));
      return found;
    }
    const size_t row = static_cast<size_t>(size_.x());
    const std::array<size_t, 3> strides = {1, row, row * static_cast<size_t>(size_.y())};
    std::array<std::array<size_t, 2>, 3> blocks, slots;  // Offsets of the two cells along each axis.
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto in_block = static_cast<size_t>(corner[static_cast<int>(axis)] & 3);
      blocks[axis] = {0, in_block == 3 ? strides[axis] : 0};
      slots[axis] = {in_block << (2 * axis), ((in_block + 1) & 3) << (2 * axis)};
    }
    const size_t first = directory_index(at);
    for (size_t k = 0; k < 8; ++k) {
      const size_t x = k & 1, y = k >> 1 & 1, z = k >> 2;
      const uint32_t block = directory_[first + blocks[0][x] + blocks[1][y] + blocks[2][z]];
      found[k] = blocks_[block][slots[0][x] | slots[1][y] | slots[2][z]];
    }
    return found;
  }

  /// The number of a covered cell, to be set: kNone at first.
  uint32_t& at(const Eigen::Vector3i& cell) {
    uint32_t& block = directory_[directory_index(block_of(cell))];
    if (block == 0) {
      block = static_cast<uint32_t>(blocks_.size());
      blocks_.emplace_back().fill(kNone);
    }
    return blocks_[block][slot_of(cell)];
  }

 private:
  Eigen::Vector3i block_of(const Eigen::Vector3i& cell) const {
    return Eigen::Vector3i(cell.x() >> 2, cell.y() >> 2, cell.z() >> 2) - low_;
  }
  size_t directory_index(const Eigen::Vector3i& at) const {
    return (static_cast<size_t>(at.z()) * static_cast<size_t>(size_.y()) + static_cast<size_t>(at.y())) *
               static_cast<size_t>(size_.x()) +
           static_cast<size_t>(at.x());
  }
  static size_t slot_of(const Eigen::Vector3i& cell) {
    return static_cast<size_t>((cell.z() & 3) << 4 | (cell.y() & 3) << 2 | (cell.x() & 3));
  }

  Eigen::Vector3i low_ = Eigen::Vector3i::Zero();   ///< first block
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();  ///< in blocks
  std::vector<uint32_t> directory_;  ///< 0 = the first block, which stays empty: look-ups need no branch
  std::vector<std::array<uint32_t, 64>> blocks_;
};

/// A surface in cells of one size: position and normal per occupied cell, in metres and in the frame of the
/// prepared scan.
struct Surfels {
  double cell = 0;
  CellGrid grid;
  std::vector<Eigen::Vector3i> cells;
  std::vector<Eigen::Vector3f>
      position;  ///< mean of the points, moved onto the fitted plane where there is one
  std::vector<Eigen::Vector3f> normal;  ///< towards where it was seen from; zero: no plane was found
  std::vector<float> weight;            ///< of the plane, 0 to 1: thin, and not seen at a grazing angle
  std::vector<Moments<3>> moments;      ///< of the cell's own points, for coarser cells
  std::vector<Eigen::Vector3f> origin;  ///< from where the cell's first point was seen

  size_t size() const { return position.size(); }
  /// The number of a cell that the grid covers, a new one if it has none yet.
  uint32_t number_of(const Eigen::Vector3i& cell, const Eigen::Vector3f& seen_from);

  /// The nearest surfel among the eight cells around a point whose normal agrees (either may have none), not
  /// farther than `radius`; CellGrid::kNone if there is none. Finds everything within half a cell.
  uint32_t nearest(const Eigen::Vector3f& point, const Eigen::Vector3f& facing, float radius) const;
  /// Whether any surface is in the eight cells around a point.
  bool near(const Eigen::Vector3f& point) const;
};

/// How planes are fitted.
struct PlaneFit {
  bool oriented = true;  ///< whether origins are known, so that normals have a side
};

/// Cells of the next size (twice as wide) out of these.
Surfels coarser(const Surfels& fine);

/// Positions, normals and weights from moments and origins. Cells with few points, and all cells of the
/// finest level (which are small compared with the noise), are fitted together with their 26 neighbours.
void fit_planes(Surfels& surfels, bool finest, const PlaneFit& fit);

/// All cells within one cell of a surfel, with the number of the nearest surfel: for the coarse search.
CellGrid dilated_grid(const Surfels& surfels);

}  // namespace loci::mapping::registration
