#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/options.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/world_triangles.h"

namespace octomap {
class OcTree;
}

namespace loci::mapping {

struct GridOptions {
  double resolution_m = 0.05;
  double min_height_m = 0.10;  ///< what is lower can be driven over
  double max_height_m = 1.50;  ///< what is higher can be driven under
  double floor_m = 0;

  void declare(loci::OptionTable& table);
};

/// A floor plan for a robot, as ROS's map_server has it.
struct OccupancyGrid {
  double resolution = 0.05;                     ///< metres
  Vector2d origin = Vector2d::Zero();           ///< lower left corner of cell (0, 0), map frame
  int width = 0, height = 0;                    ///< cells along x and y
  std::vector<loci::mapping::Occupancy> cells;  ///< row by row from the lowest y

  loci::mapping::Occupancy at(int x, int y) const { return cells[static_cast<size_t>(y * width + x)]; }
};

/// A map's cells: occupied where geometry reaches between the heights, free where only floor is, else
/// unknown. A world without floor (a warning) has its floor at `floor_m`, as far as its geometry reaches.
loci::mapping::OccupancyGrid occupancy_grid(const std::vector<loci::mapping::WorldTriangle>& triangles,
                                            const loci::mapping::GridOptions& options,
                                            loci::Warnings& warnings);

/// The columns of a tree: occupied where any voxel between the heights is, free where any is free and none
/// occupied, else unknown. The tree's resolution is the grid's.
loci::mapping::OccupancyGrid occupancy_grid(const octomap::OcTree& tree,
                                            const loci::mapping::GridOptions& options);

/// The same of scans. Rays without return count for nothing: a dark or glossy wall sends nothing back,
/// either. Free is only what free cells connect with the sensor's positions.
loci::mapping::OccupancyGrid occupancy_grid(const loci::mapping::ScanSet& scans,
                                            const loci::mapping::GridOptions& options);

/// map_server's PGM (254 free, 0 occupied, 205 unknown; first row = highest y).
std::string pgm_text(const loci::mapping::OccupancyGrid& grid);
/// The YAML beside it.
std::string grid_yaml(const loci::mapping::OccupancyGrid& grid, const std::string& image);

/// Geometry as OctoMap's binary tree (.bt): occupied where a surface is, all else unknown.
void write_surface_tree(const std::vector<loci::mapping::WorldTriangle>& triangles, double resolution,
                        const std::filesystem::path& path);

}  // namespace loci::mapping
