#pragma once

#include <vector>

#include "mapping/interpretation/supports/supports.h"

namespace loci::mapping {

/// Evidence about the plane of a possible support, as points in the map's x, y.
struct PlaneEvidence {
  struct SupportPoint {
    Vector2d position;
    float height;
    uint16_t scan;
  };
  std::vector<SupportPoint> support;    ///< upward points at the height
  std::vector<SupportPoint> uncertain;  ///< points at the height that may be upward: near edges
  std::vector<Vector2d> pierced;        ///< where rays passed through to far below
  std::vector<Vector2d> sunk;           ///< where rays ended a little below: a sink, a chair's seat
  std::vector<Vector2d> taken;          ///< upward points of other supports
  std::vector<Vector2d> above;          ///< points right above: objects
  std::vector<Vector2d> shadow;         ///< where objects above hide the plane
  std::vector<Vector2d> below;          ///< vertical surface below the slab's edge
  std::vector<Vector2d> rim;            ///< points of the slab's vertical edge
};

/// A raster over that plane in axes rotated by `yaw`.
class PlaneRaster {
 public:
  /// Covers the box of the `seed` points, grown by `margin`.
  PlaneRaster(const PlaneEvidence& evidence, const std::vector<Vector2d>& seed, double yaw, double cell,
              double margin);

  /// The rectangle with the largest sum of scores; of zero size when no sum is positive.
  Extent best_rectangle(double* score = nullptr) const;
  /// The sum of scores within a polygon of the map, in m².
  double score_of(const std::vector<Vector2d>& polygon) const;
  /// The sum of scores, in m², of the cells of a rectangle that lie in none of the others.
  double score_outside(const Extent& extent, const std::vector<Extent>& others) const;
  /// The outer boundary, in the map, of the surface in and around a box, with small gaps closed.
  std::vector<Vector2d> contour(const Extent& box) const;
  /// Excludes a rectangle from later searches.
  void consume(const Extent& extent);

  struct Counts {
    double support = 0, pierced = 0, sunk = 0, cells = 0;  ///< numbers of cells
    double rays = 0;                                       ///< that passed through or ended below
  };
  Counts count(const Extent& extent) const;
  double cell() const { return cell_; }

 private:
  struct Cell {
    int support = 0, uncertain = 0, pierced = 0, sunk = 0, above = 0, shadow = 0;
    bool open = false;  ///< rays ended a little below, as in a sink, but the room goes on from there
    bool consumed = false;
  };
  size_t number_of(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  Cell* at(const Vector2d& map_point);
  void mark_open();
  void score_cells();
  static bool is_support(const Cell& cell) {
    return cell.support > 0 && cell.pierced + cell.sunk < 4 * cell.support;
  }
  static bool is_pierced(const Cell& cell) { return !is_support(cell) && (cell.pierced >= 2 || cell.open); }
  static bool is_sunk(const Cell& cell) {
    return !is_support(cell) && cell.pierced < 2 && cell.sunk >= 2 && !cell.open;
  }

  Eigen::Rotation2Dd axes_from_map_;
  double cell_ = 0;
  Vector2d origin_ = Vector2d::Zero();
  int width_ = 0, height_ = 0;
  std::vector<Cell> cells_;
  std::vector<float> scores_;
};

}  // namespace loci::mapping
