#include "mapping/occupancy/floor_grid.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

constexpr int kFirmNeighbours = 2;  ///< of a voxel that is part of something, even of a thin pole

/// The lowest layer whose middle is higher than that.
int layer_above(const Voxels& voxels, double height) {
  int z = 0;
  while (z < voxels.size.z() && voxels.center({0, 0, z}).z() <= height) ++z;
  return z;
}

/// Occupied voxels of some layers that are not doubtful.
class FirmVoxels {
 public:
  FirmVoxels(const Voxels& voxels, int begin, int end) : voxels_(voxels), begin_(begin), end_(end) {
    if (begin >= end) return;
    const size_t from = voxels.index({0, 0, begin}), to = voxels.index({0, 0, end});
    firm_.resize(to - from);
    std::transform(voxels.states.begin() + static_cast<long>(from),
                   voxels.states.begin() + static_cast<long>(to), firm_.begin(),
                   [](Occupancy state) { return state == Occupancy::occupied ? 1 : 0; });
    for (const size_t voxel : voxels.doubtful)
      if (voxel >= from && voxel < to) firm_[voxel - from] = 0;
  }

  /// Whether a voxel is firm, and enough around it are.
  bool surface(const Eigen::Vector3i& voxel) const {
    if (!firm(voxel)) return false;
    int around = -1;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) around += firm(voxel + Eigen::Vector3i(x, y, z)) ? 1 : 0;
    return around >= kFirmNeighbours;
  }

 private:
  bool firm(const Eigen::Vector3i& voxel) const {
    return voxels_.contains(voxel) && voxel.z() >= begin_ && voxel.z() < end_ &&
           firm_[voxels_.index({voxel.x(), voxel.y(), voxel.z() - begin_})] != 0;
  }

  const Voxels& voxels_;
  int begin_, end_;
  std::vector<uint8_t> firm_;
};

}  // namespace

FloorGrid floor_grid(const Voxels& voxels, double cell_m, double body_height) {
  FloorGrid grid;
  grid.cell = std::max(cell_m, voxels.resolution);
  if (voxels.states.empty()) return grid;
  grid.low = voxels.low.head<2>();
  const Vector2d extent = voxels.resolution * voxels.size.head<2>().cast<double>();
  grid.width = static_cast<int>(std::ceil(extent.x() / grid.cell - 1e-9));
  grid.height = static_cast<int>(std::ceil(extent.y() / grid.cell - 1e-9));
  const size_t cells = static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height);
  for (auto* layer : {&grid.seen, &grid.obstacle, &grid.open, &grid.clear}) layer->assign(cells, 0);
  const double floor_height = 1.6 * voxels.resolution;
  std::vector<int> balance(cells, 0);  // Free voxels of the body's space less unknown ones.
  const int body = std::max(0, layer_above(voxels, floor_height));
  const FirmVoxels firm(voxels, body, layer_above(voxels, body_height));
  for (int z = 0; z < voxels.size.z(); ++z) {
    const double height = voxels.center({0, 0, z}).z();
    if (height < -floor_height || height > body_height) continue;
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x) {
        const Occupancy state = voxels.states[voxels.index({x, y, z})];
        const Eigen::Vector2i cell = grid.cell_of(voxels.center({x, y, z}).head<2>());
        const size_t at = grid.index(cell.x(), cell.y());
        if (z < body) {
          if (state == Occupancy::occupied) grid.seen[at] = 1;
        } else if (state == Occupancy::occupied) {
          if (firm.surface({x, y, z})) grid.obstacle[at] = 1;
        } else {
          balance[at] += state == Occupancy::free ? 1 : -1;
          if (state == Occupancy::free) grid.open[at] = 1;
        }
      }
  }
  for (size_t cell = 0; cell < cells; ++cell) grid.clear[cell] = balance[cell] > 0 ? 1 : 0;
  return grid;
}

FloorRegion::FloorRegion(const std::string& text) {
  if (text.empty()) return;
  std::istringstream in(text);
  double values[4] = {};
  bool good = true;
  for (int i = 0; i < 4; ++i) {
    char comma = ',';
    if (i > 0) in >> comma;
    good = good && in >> values[i] && comma == ',' && std::isfinite(values[i]);
  }
  if (!good || !(in >> std::ws).eof())
    throw Error("'" + text + "' is no rectangle on the floor", {"", 0, "within"},
                "give two corners: x0,y0,x1,y1 in metres");
  box_.emplace();
  box_->extend(Vector2d(values[0], values[1]));
  box_->extend(Vector2d(values[2], values[3]));
  if (box_->sizes().minCoeff() <= 0)
    throw Error("'" + text + "' has no area", {"", 0, "within"}, "give two opposite corners");
}

}  // namespace loci::mapping
