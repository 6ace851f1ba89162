#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace loci {

/// Numbers the cells of an unbounded grid 0, 1, 2, … in the order in which they are first inserted: a hash
/// table whose payload lives in arrays of the user's own. Cell coordinates lie within ±2^20.
class CellIndex {
 public:
  static constexpr uint32_t kNone = UINT32_MAX;

  explicit CellIndex(size_t expected = 1024);

  /// The number of a cell, a new one if it is not there yet.
  uint32_t insert(const Eigen::Vector3i& cell);
  /// The number of a cell, or kNone.
  uint32_t find(const Eigen::Vector3i& cell) const;

  size_t size() const { return cells_.size(); }
  /// Cell of every number.
  const std::vector<Eigen::Vector3i>& cells() const { return cells_; }

 private:
  void grow();
  size_t slot_of(uint64_t key) const;

  std::vector<uint64_t> keys_;     ///< packed cell + 1; 0 = free
  std::vector<uint32_t> numbers_;  ///< beside keys_
  std::vector<Eigen::Vector3i> cells_;
};

/// The cell of a position in a grid of a given cell size.
template <class Vector>
Eigen::Vector3i cell_of(const Vector& position, double cell_size) {
  return (position.template cast<double>() / cell_size).array().floor().template cast<int>();
}

}  // namespace loci
