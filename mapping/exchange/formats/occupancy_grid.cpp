#include "mapping/exchange/formats/occupancy_grid.h"

#include <fmt/format.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "mapping/base/files.h"

namespace loci::mapping {
namespace {

constexpr double kUnknownMargin = 0.5;  // m of unknown around everything
constexpr double kFloor = 0.05;         // m; upward faces so near to the floor's height are floor
constexpr double kMinFloor = 0.1;       // of the area that the geometry spans
constexpr double kMaxCells = 4e8;
constexpr int kShift = 4;  // fractional bits of OpenCV's polygon corners

/// The part of a triangle between two heights, as a polygon.
std::vector<Vector3d> slice(const WorldTriangle& triangle, double low, double high) {
  std::vector<Vector3d> polygon(triangle.corners.begin(), triangle.corners.end());
  for (const auto& [sign, limit] : {std::pair{1.0, low}, {-1.0, -high}}) {
    std::vector<Vector3d> kept;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Vector3d& a = polygon[i];
      const Vector3d& b = polygon[(i + 1) % polygon.size()];
      const double of_a = sign * a.z() - limit;
      const double of_b = sign * b.z() - limit;
      if (of_a >= 0) kept.push_back(a);
      if ((of_a >= 0) != (of_b >= 0)) kept.emplace_back(a + of_a / (of_a - of_b) * (b - a));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

OccupancyGrid empty_grid(const Eigen::AlignedBox2d& box, double resolution) {
  OccupancyGrid grid;
  grid.resolution = resolution;
  const Vector2d low = ((box.min().array() - kUnknownMargin) / resolution).floor();
  const Vector2d high = ((box.max().array() + kUnknownMargin) / resolution).ceil();
  grid.origin = low * resolution;
  const Vector2d size = high - low;
  if (size.prod() > kMaxCells) throw Error("the grid has too many cells", {}, "choose a coarser resolution");
  grid.width = static_cast<int>(size.x());
  grid.height = static_cast<int>(size.y());
  grid.cells.assign(static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height), Occupancy::unknown);
  return grid;
}

/// Every cell that a polygon touches.
void fill(cv::Mat& mask, const OccupancyGrid& grid, const std::vector<Vector3d>& polygon) {
  if (polygon.empty()) return;
  std::vector<cv::Point> corners;
  for (const Vector3d& corner : polygon) {
    // OpenCV's pixels have their centres at integers.
    const Vector2d at =
        ((corner.head<2>() - grid.origin) / grid.resolution - Vector2d::Constant(0.5)) * (1 << kShift);
    corners.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  }
  cv::fillConvexPoly(mask, corners, cv::Scalar(255), cv::LINE_8, kShift);
}

bool is_floor(const WorldTriangle& triangle, double height) {
  return triangle.normal.z() > 0.9 && std::ranges::all_of(triangle.corners, [&](const Vector3d& corner) {
           return std::abs(corner.z() - height) < kFloor;
         });
}

void require_heights_in_order(const GridOptions& options) {
  if (options.min_height_m >= options.max_height_m)
    throw Error(fmt::format("no height is an obstacle's: min_height_m is {}, max_height_m {}",
                            options.min_height_m, options.max_height_m),
                {}, "max_height_m is the robot's height, min_height_m what it drives over");
}

}  // namespace

void GridOptions::declare(OptionTable& table) {
  table.number("resolution_m", resolution_m, "m", "Size of a cell, or of a voxel.", 0.001, 1);
  table.number("min_height_m", min_height_m, "m", "Lower obstacles can be driven over (grid).", 0, 10);
  table.number("max_height_m", max_height_m, "m", "Higher obstacles can be driven under (grid).", 0, 10);
  table.number("floor_m", floor_m, "m", "Height of the floor (grid).", -100, 100);
}

OccupancyGrid occupancy_grid(const std::vector<WorldTriangle>& triangles, const GridOptions& options,
                             Warnings& warnings) {
  require_heights_in_order(options);
  Eigen::AlignedBox2d box;
  for (const WorldTriangle& triangle : triangles)
    for (const Vector3d& corner : triangle.corners) box.extend(corner.head<2>());
  if (box.isEmpty()) throw Error("the map has no geometry to make a grid of");
  OccupancyGrid grid = empty_grid(box, options.resolution_m);
  cv::Mat occupied = cv::Mat::zeros(grid.height, grid.width, CV_8UC1);
  cv::Mat floor = occupied.clone();
  for (const WorldTriangle& triangle : triangles) {
    fill(occupied, grid,
         slice(triangle, options.floor_m + options.min_height_m, options.floor_m + options.max_height_m));
    if (is_floor(triangle, options.floor_m))
      fill(floor, grid, {triangle.corners.begin(), triangle.corners.end()});
  }
  // Sills and plinths lie low, too, but are no floor.
  const double reached = box.sizes().prod() / (options.resolution_m * options.resolution_m);
  if (cv::countNonZero(floor) < kMinFloor * reached) {
    warnings.add("the map has no floor: all that its geometry encloses counts as floor");
    const Vector3d low(box.min().x(), box.min().y(), 0);
    const Vector3d high(box.max().x(), box.max().y(), 0);
    fill(floor, grid, {low, {high.x(), low.y(), 0}, high, {low.x(), high.y(), 0}});
  }
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x)
      grid.cells[static_cast<size_t>(y * grid.width + x)] = occupied.at<uchar>(y, x) != 0
                                                                ? Occupancy::occupied
                                                            : floor.at<uchar>(y, x) != 0 ? Occupancy::free
                                                                                         : Occupancy::unknown;
  return grid;
}

OccupancyGrid occupancy_grid(const octomap::OcTree& tree, const GridOptions& options) {
  require_heights_in_order(options);
  Vector3d low, high;
  tree.getMetricMin(low.x(), low.y(), low.z());
  tree.getMetricMax(high.x(), high.y(), high.z());
  if (tree.size() == 0) throw Error("the scans leave nothing known to make a grid of");
  OccupancyGrid grid = empty_grid({low.head<2>(), high.head<2>()}, tree.getResolution());
  const double bottom = options.floor_m + options.min_height_m;
  const double top = options.floor_m + options.max_height_m;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const double half = leaf.getSize() / 2;
    if (leaf.getZ() + half <= bottom || leaf.getZ() - half >= top) continue;
    const Occupancy seen = tree.isNodeOccupied(*leaf) ? Occupancy::occupied : Occupancy::free;
    const auto first = [&](double value, double origin) {
      return static_cast<int>(std::lround((value - half - origin) / grid.resolution));
    };
    const int cells = static_cast<int>(std::lround(leaf.getSize() / grid.resolution));
    const int left = first(leaf.getX(), grid.origin.x());
    const int lowest = first(leaf.getY(), grid.origin.y());
    for (int y = lowest; y < lowest + cells; ++y)
      for (int x = left; x < left + cells; ++x) {
        Occupancy& cell = grid.cells[static_cast<size_t>(y * grid.width + x)];
        cell = std::max(cell, seen);  // unknown < free < occupied
      }
  }
  return grid;
}

namespace {

constexpr double kSensorReach_m = 0.5;  ///< from the sensor to the nearest free cell

/// Free cells that no chain of free neighbours connects with a sensor become unknown.
void keep_reached(const std::vector<Vector2d>& sensors, OccupancyGrid& grid) {
  std::vector<uint8_t> reached(grid.cells.size(), 0);
  std::vector<int> open;
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) return;
    const int cell = y * grid.width + x;
    if (reached[static_cast<size_t>(cell)] != 0 || grid.at(x, y) != Occupancy::free) return;
    reached[static_cast<size_t>(cell)] = 1;
    open.push_back(cell);
  };
  const int reach = static_cast<int>(std::ceil(kSensorReach_m / grid.resolution));
  for (const Vector2d& sensor : sensors) {
    const Vector2d at = (sensor - grid.origin) / grid.resolution;
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx)
        if (dx * dx + dy * dy <= reach * reach)
          visit(static_cast<int>(std::floor(at.x())) + dx, static_cast<int>(std::floor(at.y())) + dy);
  }
  while (!open.empty()) {
    const int x = open.back() % grid.width, y = open.back() / grid.width;
    open.pop_back();
    visit(x + 1, y);
    visit(x - 1, y);
    visit(x, y + 1);
    visit(x, y - 1);
  }
  for (size_t i = 0; i < grid.cells.size(); ++i)
    if (grid.cells[i] == Occupancy::free && reached[i] == 0) grid.cells[i] = Occupancy::unknown;
}

}  // namespace

OccupancyGrid occupancy_grid(const ScanSet& scans, const GridOptions& options) {
  OccupancyOptions occupancy;
  occupancy.resolution_m = options.resolution_m;
  if (scans.range_max > 0) occupancy.range_max_m = scans.range_max;
  OccupancyMap map(occupancy);
  std::vector<Vector2d> sensors;
  for (Scan scan : scans.scans) {
    std::erase_if(scan.points, [](const ScanPoint& point) { return !point.returned; });
    for (const Eigen::Vector3f& origin : scan.origins)
      sensors.push_back((scan.map_from_scan * origin.cast<double>()).head<2>());
    map.insert(scan);
  }
  OccupancyGrid grid = occupancy_grid(map.tree(), options);
  keep_reached(sensors, grid);
  return grid;
}

std::string pgm_text(const OccupancyGrid& grid) {
  std::string text =
      fmt::format("P5\n# {} m per cell\n{} {}\n255\n", grid.resolution, grid.width, grid.height);
  for (int y = grid.height - 1; y >= 0; --y)
    for (int x = 0; x < grid.width; ++x) {
      const Occupancy cell = grid.at(x, y);
      text += static_cast<char>(cell == Occupancy::occupied ? 0 : cell == Occupancy::free ? 254 : 205);
    }
  return text;
}

std::string grid_yaml(const OccupancyGrid& grid, const std::string& image) {
  return fmt::format(
      "image: {}\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: "
      "0.196\n",
      image, grid.resolution, grid.origin.x(), grid.origin.y());
}

void write_surface_tree(const std::vector<WorldTriangle>& triangles, double resolution,
                        const std::filesystem::path& path) {
  octomap::OcTree tree(resolution);
  // A voxel's key has 16 bits.
  const double reach = resolution * 32768;
  double samples = 0;
  for (const WorldTriangle& triangle : triangles) {
    const Vector3d a = triangle.corners[1] - triangle.corners[0],
                   b = triangle.corners[2] - triangle.corners[0];
    samples += a.cross(b).norm() / (resolution * resolution);
    for (const Vector3d& corner : triangle.corners)
      if (corner.cwiseAbs().maxCoeff() > reach)
        throw Error(fmt::format("a corner of the map is farther than {:.0f} m from the origin", reach), {},
                    "choose a coarser resolution, or move the map to the origin");
  }
  if (samples > kMaxCells) throw Error("the map has too many voxels", {}, "choose a coarser resolution");
  // Steps of less than half a voxel miss no voxel by more than a corner.
  const double step = resolution / 2.5;
  for (const WorldTriangle& triangle : triangles) {
    const Vector3d a = triangle.corners[1] - triangle.corners[0];
    const Vector3d b = triangle.corners[2] - triangle.corners[0];
    const int along_a = static_cast<int>(std::ceil(a.norm() / step)) + 1;
    const int along_b = static_cast<int>(std::ceil(b.norm() / step)) + 1;
    for (int i = 0; i <= along_a; ++i)
      for (int j = 0; j <= along_b; ++j) {
        const double u = static_cast<double>(i) / along_a;
        const double v = static_cast<double>(j) / along_b;
        if (u + v > 1 + 1e-9) break;
        const Vector3d point = triangle.corners[0] + u * a + v * b;
        octomap::OcTreeKey key;
        if (tree.coordToKeyChecked(point.x(), point.y(), point.z(), key) && tree.search(key) == nullptr)
          tree.setNodeValue(key, tree.getClampingThresMaxLog(), true);
      }
  }
  tree.updateInnerOccupancy();
  tree.prune();
  std::ostringstream bytes;
  tree.writeBinaryConst(bytes);
  write_file_atomically(path, bytes.str());
}

}  // namespace loci::mapping
