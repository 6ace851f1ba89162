#include "mapping/occupancy/floor_grid.h"

#include <cmath>

namespace loci {

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
  for (int z = 0; z < voxels.size.z(); ++z) {
    const double height = voxels.center({0, 0, z}).z();
    if (height < -floor_height || height > body_height) continue;
    std::vector<uint8_t>& occupied = height > floor_height ? grid.obstacle : grid.seen;
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x) {
        const Occupancy state = voxels.states[voxels.index({x, y, z})];
        const Eigen::Vector2i cell = grid.cell_of(voxels.center({x, y, z}).head<2>());
        const size_t at = grid.index(cell.x(), cell.y());
        if (state == Occupancy::occupied)
          occupied[at] = 1;
        else if (height > floor_height) {
          balance[at] += state == Occupancy::free ? 1 : -1;
          if (state == Occupancy::free) grid.open[at] = 1;
        }
      }
  }
  for (size_t cell = 0; cell < cells; ++cell) grid.clear[cell] = balance[cell] > 0 ? 1 : 0;
  return grid;
}

}  // namespace loci
