#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/interpretation/surfaces/surface.h"
#include "mapping/interpretation/surfaces/vertical_planes.h"

namespace loci::mapping {

/// Ray evidence about a vertical plane, as fractions of its columns or cells.
struct RayEvidence {
  double seen_above = 0;   ///< columns above whose top rays crossed the plane
  double passed_over = 0;  ///< columns above whose top rays crossed it and ended on a surface behind it
  double pierced = 0;      ///< of the cells that were seen or crossed, those that rays crossed
};

/// Counts rays in square cells of a plane and above it.
class PlaneCells {
 public:
  /// Keeps a reference. A ray that ends within `on_plane` of the plane ends on it, one that ends more than
  /// `crossed` behind has crossed it, others do not count; metres.
  PlaneCells(const VerticalPlane& plane, double cell, double on_plane, double crossed);

  /// All rays of a surface, or one of `step`.
  void add(const Surface& surface, size_t step = 1);

  RayEvidence evidence() const;
  size_t columns() const { return columns_; }
  size_t rows() const { return rows_; }
  /// Rays that ended on the plane, and those that crossed it; column 0 at along_min, row 0 at the bottom.
  int hits(size_t column, size_t row) const { return hits_[row * columns_ + column]; }
  int passes(size_t column, size_t row) const { return passes_[row * columns_ + column]; }

 private:
  void add_ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool returned);

  const VerticalPlane& plane_;
  Eigen::Vector2f normal_, direction_;
  float offset_, on_plane_, crossed_;
  double cell_;
  size_t columns_, rows_;
  std::vector<int> hits_, passes_;      ///< by cell
  std::vector<int> seen_above_, over_;  ///< by column
};

}  // namespace loci::mapping
