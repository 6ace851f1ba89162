#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapping/occupancy/occupancy.h"

namespace loci::mapping {

/// What is known of the floor, for driving: cells of the map's x and y, x fastest.
struct FloorGrid {
  double cell = 0;                  ///< metres
  Vector2d low = Vector2d::Zero();  ///< corner of the first cell, map frame, metres
  int width = 0, height = 0;        ///< cells in x and in y
  std::vector<uint8_t> seen;        ///< the floor was scanned here (an occupied voxel at z ≈ 0)
  std::vector<uint8_t> obstacle;    ///< something stands or hangs here where the robot's body would be
  std::vector<uint8_t> open;        ///< some of the body's space is known to be free
  std::vector<uint8_t> clear;       ///< most of it is: not so under what only its shadow is known of

  size_t cells() const { return seen.size(); }
  size_t index(int x, int y) const {
    return static_cast<size_t>(x) + static_cast<size_t>(width) * static_cast<size_t>(y);
  }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  Eigen::Vector2i cell_of(const Vector2d& point) const {
    return ((point - low) / cell).array().floor().cast<int>();
  }
  Vector2d center(int x, int y) const { return low + cell * Vector2d(x + 0.5, y + 0.5); }
};

/// Projects voxels of a levelled map (floor at z = 0) onto the floor. Cells are at least one voxel wide. The
/// floor is what is occupied within 1.6 voxels of z = 0; what is occupied above that, up to `body_height`
/// metres, is an obstacle: the robot's body. Doubtful voxels, and those that are
/// occupied with less than two others around them, are none: so are the false points behind edges, while even
/// a thin pole is a row of voxels.
FloorGrid floor_grid(const Voxels& voxels, double cell_m, double body_height);

/// A rectangle on the floor along the map's axes, or all of it: what an exploration keeps to.
class FloorRegion {
 public:
  FloorRegion() = default;
  /// "x0,y0,x1,y1" in metres, any two opposite corners; empty text = everywhere. Error for anything else.
  explicit FloorRegion(const std::string& text);

  bool contains(const Vector2d& point) const { return !box_ || box_->contains(point); }
  bool everywhere() const { return !box_; }

 private:
  std::optional<Eigen::AlignedBox2d> box_;
};

}  // namespace loci::mapping
