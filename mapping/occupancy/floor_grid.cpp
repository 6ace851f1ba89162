#include "mapping/occupancy/floor_grid.h"

#include <fmt/format.h>

#include <cmath>

#include "mapping/base/files.h"

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
  for (auto* layer : {&grid.seen, &grid.obstacle, &grid.open}) layer->assign(cells, 0);
  const double floor_height = 1.6 * voxels.resolution;
  for (int z = 0; z < voxels.size.z(); ++z) {
    const double height = voxels.center({0, 0, z}).z();
    if (height < -floor_height || height > body_height) continue;
    std::vector<uint8_t>& occupied = height > floor_height ? grid.obstacle : grid.seen;
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x) {
        const Occupancy state = voxels.states[voxels.index({x, y, z})];
        if (state == Occupancy::unknown) continue;
        const Eigen::Vector2i cell = grid.cell_of(voxels.center({x, y, z}).head<2>());
        const size_t at = grid.index(cell.x(), cell.y());
        if (state == Occupancy::occupied)
          occupied[at] = 1;
        else if (height > floor_height)
          grid.open[at] = 1;
      }
  }
  return grid;
}

void write_map_server_grid(const FloorGrid& grid, const std::filesystem::path& path) {
  std::string pixels = fmt::format("P5\n{} {}\n255\n", grid.width, grid.height);
  for (int y = grid.height - 1; y >= 0; --y)  // The picture's first row is the map's last.
    for (int x = 0; x < grid.width; ++x) {
      const size_t at = grid.index(x, y);
      pixels += static_cast<char>(grid.obstacle[at] != 0 ? 0 : grid.seen[at] != 0 ? 254 : 205);
    }
  write_file_atomically(path, pixels);
  std::filesystem::path yaml = path;
  write_file_atomically(
      yaml.replace_extension(".yaml"),
      fmt::format("image: {}\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
                  "free_thresh: 0.196\n",
                  path.filename().string(), grid.cell, grid.low.x(), grid.low.y()));
}

}  // namespace loci
