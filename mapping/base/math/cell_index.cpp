#include "mapping/base/math/cell_index.h"

#include <bit>

namespace loci {
namespace {

uint64_t key_of(const Eigen::Vector3i& cell) {
  constexpr uint64_t kMask = (1ULL << 21) - 1;
  const auto part = [](int value) { return static_cast<uint64_t>(value + (1 << 20)) & kMask; };
  return (part(cell.x()) << 42 | part(cell.y()) << 21 | part(cell.z())) + 1;
}

/// Spreads neighbouring keys over the table (the finaliser of splitmix64).
uint64_t mixed(uint64_t key) {
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9ULL;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebULL;
  return key ^ (key >> 31);
}

}  // namespace

CellIndex::CellIndex(size_t expected)
    : keys_(std::bit_ceil(2 * expected + 16), 0), numbers_(keys_.size(), kNone) {
  cells_.reserve(expected);
}

size_t CellIndex::slot_of(uint64_t key) const {
  const size_t mask = keys_.size() - 1;
  size_t slot = mixed(key) & mask;
  while (keys_[slot] != 0 && keys_[slot] != key) slot = (slot + 1) & mask;
  return slot;
}

uint32_t CellIndex::find(const Eigen::Vector3i& cell) const {
  const size_t slot = slot_of(key_of(cell));
  return keys_[slot] == 0 ? kNone : numbers_[slot];
}

uint32_t CellIndex::insert(const Eigen::Vector3i& cell) {
  const uint64_t key = key_of(cell);
  size_t slot = slot_of(key);
  if (keys_[slot] != 0) return numbers_[slot];
  if (2 * (cells_.size() + 1) > keys_.size()) {
    grow();
    slot = slot_of(key);
  }
  keys_[slot] = key;
  numbers_[slot] = static_cast<uint32_t>(cells_.size());
  cells_.push_back(cell);
  return numbers_[slot];
}

void CellIndex::grow() {
  keys_.assign(2 * keys_.size(), 0);
  numbers_.assign(keys_.size(), kNone);
  for (size_t number = 0; number < cells_.size(); ++number) {
    const uint64_t key = key_of(cells_[number]);
    const size_t slot = slot_of(key);
    keys_[slot] = key;
    numbers_[slot] = static_cast<uint32_t>(number);
  }
}

}  // namespace loci
