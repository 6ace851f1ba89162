#include "mapping/interpretation/supports/legs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"

namespace loci::mapping {
namespace {

/// The points below a table's top, cell by cell: which levels between floor and top each cell has.
class Undercroft {
 public:
  Undercroft(const Surface& surface, double floor_height, const Support& table) {
    Extent all = Extent::empty();
    for (const Extent& part : table.parts) all.extend(part);
    min_ = all.min;
    middle_ = (all.centre() - min_) / kLegs.cell_m;
    const double low = floor_height + kLegs.above_floor_m, high = table.height - kLegs.below_top_m;
    levels_ = std::clamp(static_cast<int>((high - low) / kLegs.level_m), 0, 64);
    cols_ = static_cast<int>(all.size().x() / kLegs.cell_m) + 1;
    rows_ = static_cast<int>(all.size().y() / kLegs.cell_m) + 1;
    cells_.resize(static_cast<size_t>(cols_) * static_cast<size_t>(rows_));
    const Eigen::Rotation2Dd axes_from_map(-table.yaw);
    for (const SurfacePoint& point : surface.points) {
      const int level =
          static_cast<int>(std::floor((static_cast<double>(point.position.z()) - low) / kLegs.level_m));
      const Vector2d at = point.position.head<2>().cast<double>();
      if (level < 0 || level >= levels_ || !table.contains(at)) continue;
      const Vector2d in_axes = axes_from_map * at;
      const Vector2d cell = (in_axes - min_) / kLegs.cell_m;
      cells_[index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))] |= uint64_t{1} << level;
      points_.push_back(in_axes);
    }
  }

  /// Cells with a post: points on most levels, and up to the top, which tells legs from those of chairs.
  cv::Mat posts() const {
    cv::Mat mask = cv::Mat::zeros(rows_, cols_, CV_8U);
    if (levels_ < kLegs.min_levels) return mask;
    const int third = levels_ / 3;
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < cols_; ++x) {
        if (cells_[index(x, y)] == 0) continue;
        const uint64_t seen = around(x, y);
        const bool up_to_top = std::popcount(seen) >= kLegs.seen_levels * levels_ &&
                               std::popcount(seen >> (levels_ - third)) >= kLegs.seen_levels * third;
        const bool central = (Vector2d(x, y) - middle_).norm() * kLegs.cell_m < kLegs.central_m &&
                             std::popcount(seen) >= kLegs.seen_central * levels_;
        if (up_to_top || central) mask.at<uchar>(y, x) = 255;
      }
    return mask;
  }

  /// What the points in a rectangle of cells span; a side of which less was seen is as thick as a thin leg.
  Leg span(const cv::Rect& cells) const {
    const Extent area{min_ + kLegs.cell_m * Vector2d(cells.x, cells.y),
                      min_ + kLegs.cell_m * Vector2d(cells.x + cells.width, cells.y + cells.height)};
    std::vector<double> x, y;
    for (const Vector2d& point : points_)
      if (area.contains(point)) x.push_back(point.x()), y.push_back(point.y());
    Extent extent{{quantile(x, kLegs.outliers), quantile(y, kLegs.outliers)},
                  {quantile(x, 1 - kLegs.outliers), quantile(y, 1 - kLegs.outliers)}};
    const Vector2d half = extent.size().cwiseMax(kLegs.min_side_m) / 2, centre = extent.centre();
    return {{centre - half, centre + half}, x.size()};
  }

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(cols_) + static_cast<size_t>(x);
  }

  /// Levels of a cell and its neighbours: noise spreads the side of a leg over them.
  uint64_t around(int x, int y) const {
    uint64_t levels = 0;
    for (int v = std::max(0, y - 1); v <= std::min(rows_ - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(cols_ - 1, x + 1); ++u) levels |= cells_[index(u, v)];
    return levels;
  }

  Vector2d min_, middle_;  ///< the middle in cells
  int levels_ = 0, cols_ = 0, rows_ = 0;
  std::vector<uint64_t> cells_;
  std::vector<Vector2d> points_;
};

}  // namespace

std::vector<Leg> find_legs(const Surface& surface, double floor_height, const Support& table) {
  const Undercroft below(surface, floor_height, table);
  cv::Mat labels, boxes, centres;
  const int count = cv::connectedComponentsWithStats(below.posts(), labels, boxes, centres);
  std::vector<Leg> legs;
  for (int i = 1; i < count; ++i) {
    const cv::Rect box(boxes.at<int>(i, cv::CC_STAT_LEFT), boxes.at<int>(i, cv::CC_STAT_TOP),
                       boxes.at<int>(i, cv::CC_STAT_WIDTH), boxes.at<int>(i, cv::CC_STAT_HEIGHT));
    if (std::max(box.width, box.height) * kLegs.cell_m <= kLegs.max_side_m) legs.push_back(below.span(box));
  }
  // Mixed returns beside the edge of the top make thin posts of few points.
  size_t most = 0;
  for (const Leg& leg : legs) most = std::max(most, leg.inliers);
  std::erase_if(legs, [&](const Leg& leg) {
    return static_cast<double>(leg.inliers) < kLegs.min_points * static_cast<double>(most);
  });
  return legs;
}

}  // namespace loci::mapping
