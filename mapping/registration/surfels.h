#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/registration/cell_grid.h"

namespace loci::mapping::registration {

/// What is summed over the points of a cell to fit a plane to them.
struct Moments {
  double count = 0;
  Vector3d sum = Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();

  void add(const Vector3d& point) {
    ++count;
    sum += point;
    products += point * point.transpose();
  }
  void add(const Moments& other) {
    count += other.count;
    sum += other.sum;
    products += other.products;
  }
};

/// A surface in cells of one size: per occupied cell where its points lie and how the surface stands there.
/// Arrays of what is used together; positions in metres, in the frame of the prepared scan.
struct Surfels {
  double cell = 0;
  CellGrid grid;
  std::vector<Eigen::Vector3i> cells;
  std::vector<Eigen::Vector3f>
      position;  ///< mean of the points, moved onto the fitted plane where there is one
  std::vector<Eigen::Vector3f> normal;  ///< towards where it was seen from; zero: no plane was found
  std::vector<float> trust;             ///< of the plane, 0 to 1: thin, and not seen at a grazing angle
  std::vector<Moments> moments;         ///< of the cell's own points, for coarser cells
  std::vector<Eigen::Vector3f> origin;  ///< from where the cell's first point was seen

  size_t size() const { return position.size(); }
  /// The number of a cell that the grid covers, a new one if it has none yet.
  uint32_t number_of(const Eigen::Vector3i& cell, const Eigen::Vector3f& seen_from);

  /// The nearest surfel among the eight cells around a point whose normal agrees (either may have none), not
  /// farther than `radius`; CellGrid::kNone if there is none. Finds everything within half a cell.
  uint32_t nearest(const Eigen::Vector3f& point, const Eigen::Vector3f& facing, float radius) const;
  /// Whether any surface is in the eight cells around a point.
  bool near(const Eigen::Vector3f& point) const;
};

/// How planes are fitted.
struct PlaneFit {
  bool oriented = true;  ///< whether origins are known, so that normals have a side
};

/// Cells of the next size (twice as wide) out of these.
Surfels coarser(const Surfels& fine);

/// Positions, normals and trust out of moments and origins. A cell with few points of its own is fitted
/// together with its 26 neighbours; the finest level always is, as a cell is small against the noise.
void fit_planes(Surfels& surfels, bool finest, const PlaneFit& fit);

/// Every cell within one cell of a surfel, with the number of the nearest one: a wide net for a coarse
/// search.
CellGrid wide_net(const Surfels& surfels);

}  // namespace loci::mapping::registration
