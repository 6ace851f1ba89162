#include "mapping/registration/cell_grid.h"

#include <algorithm>

namespace loci::mapping::registration {
namespace {

Eigen::Vector3i blocks_of(const Eigen::Vector3i& cell) {
  return {cell.x() >> 2, cell.y() >> 2, cell.z() >> 2};
}

}  // namespace

CellGrid::CellGrid(const Eigen::Vector3i& low, const Eigen::Vector3i& high, const Eigen::Vector3i& centre) {
  low_ = blocks_of(low);
  Eigen::Vector3i last = blocks_of(high);
  const auto volume = [&] { return (last - low_).cast<int64_t>().array().max(0) + 1; };
  for (int reach = 1 << 18; volume().cast<double>().prod() > static_cast<double>(kBlocksMax); reach /= 2) {
    low_ = low_.cwiseMax((blocks_of(centre).array() - reach).matrix());
    last = last.cwiseMin((blocks_of(centre).array() + reach).matrix());
  }
  size_ = (last - low_).array().max(-1) + 1;
  directory_.assign(static_cast<size_t>(size_.cast<int64_t>().prod()), kNone);
}

}  // namespace loci::mapping::registration
