#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "perception/detection/people_detector.h"

namespace loci::perception {

/// A frame as arms are looked for in it: at a coarser grid, with the horizontal surfaces taken out.
class ArmGrid {
 public:
  /// `frame` has a pose; lives longer.
  explicit ArmGrid(const PeopleFrame& frame);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  size_t size() const { return points_.size(); }
  size_t cell(int row, int column) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  }

  /// Depth camera's frame, metres; NaN = not measured.
  const Eigen::Vector3f& point(size_t cell) const { return points_[cell]; }
  /// Unit, depth camera's frame.
  const Eigen::Vector3f& up() const { return up_; }
  float height(const Eigen::Vector3f& point) const { return point.dot(up_); }
  /// Measured near enough, and neither of the map nor of a horizontal surface.
  bool is_free(size_t cell) const { return free_[cell] != 0; }
  /// Has a colour that skin may have; false where it is not free.
  bool is_skin(size_t cell) const { return skin_[cell] != 0; }

  /// Calls `visit` with the neighbours that are free and on the same surface.
  template <typename Visit>
  void for_each_neighbour(size_t cell, Visit visit) const {
    const int row = static_cast<int>(cell) / columns_, column = static_cast<int>(cell) % columns_;
    for (const auto& [down, right] : {std::pair{0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
      const int r = row + down, c = column + right;
      if (r < 0 || c < 0 || r >= rows_ || c >= columns_) continue;
      const size_t next = this->cell(r, c);
      if (is_free(next) && on_one_surface(points_[cell].z(), points_[next].z())) visit(next);
    }
  }
  /// Whether depths of neighbours, in metres, may be of one surface.
  static bool on_one_surface(float a, float b);

  /// Whether no horizontal surface is so near below a height that what stands there would reach it.
  bool is_in_the_air(float height) const;
  /// Whether a table or a counter is below a point.
  bool is_over_a_surface(const Eigen::Vector3f& point) const;

  /// The pixels of the depth image that belong to cells, row · width + column, ascending.
  std::vector<int> pixels_of(const std::vector<size_t>& cells) const;

 private:
  /// A cell with its normal, towards the camera, and its area in m².
  struct Facet {
    size_t cell;
    Eigen::Vector3f normal;
    double area;
  };

  std::vector<Facet> facets() const;
  void find_surfaces();
  /// The cell of the floor plan below a point.
  std::pair<int, int> below(const Eigen::Vector3f& point) const;
  /// Whether a point is on one of the surfaces.
  bool is_on_a_surface(const Eigen::Vector3f& point) const;

  const PeopleFrame& frame_;
  int step_, rows_, columns_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<uint8_t> free_, skin_;
  Eigen::Vector3f up_, east_, north_;          ///< an orthonormal frame
  std::vector<float> surfaces_;                ///< heights, ascending
  std::map<std::pair<int, int>, float> plan_;  ///< height of the highest surface in cells of the floor plan
};

}  // namespace loci::perception
