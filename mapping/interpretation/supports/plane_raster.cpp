#include "mapping/interpretation/supports/plane_raster.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/interpretation/supports/parameters.h"

namespace loci::mapping {
namespace {

const Vector2d& position_of(const Vector2d& point) {
  return point;
}
const Vector2d& position_of(const PlaneEvidence::SupportPoint& point) {
  return point.position;
}

}  // namespace

PlaneRaster::PlaneRaster(const PlaneEvidence& evidence, const std::vector<Vector2d>& seed, double yaw,
                         double cell, double margin)
    : axes_from_map_(-yaw), cell_(cell) {
  Extent box = Extent::empty();
  for (const Vector2d& point : seed) box.extend(Vector2d(axes_from_map_ * point));
  origin_ = (box.min.array() - margin).matrix();
  const Vector2d size = (box.max - box.min).array() + 2 * margin;
  width_ = static_cast<int>(size.x() / cell_) + 1;
  height_ = static_cast<int>(size.y() / cell_) + 1;
  cells_.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  const auto count = [&](const auto& points, int Cell::*field) {
    for (const auto& point : points)
      if (Cell* cell_at = at(position_of(point))) ++(cell_at->*field);
  };
  count(evidence.support, &Cell::support);
  count(evidence.uncertain, &Cell::uncertain);
  count(evidence.pierced, &Cell::pierced);
  count(evidence.sunk, &Cell::sunk);
  count(evidence.above, &Cell::above);
  count(evidence.shadow, &Cell::shadow);
  for (const Vector2d& point : evidence.taken)
    if (Cell* cell_at = at(point)) cell_at->consumed = true;
  mark_open();
  score_cells();
}

void PlaneRaster::mark_open() {
  cv::Mat passed(height_, width_, CV_8UC1), labels, stats, centroids;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Cell& cell = cells_[number_of(x, y)];
      passed.at<uint8_t>(y, x) = is_pierced(cell) || is_sunk(cell) ? 255 : 0;
    }
  // A slab's edge that few points show does not join a sink to the room before it.
  cv::morphologyEx(passed, passed, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  const int pieces = cv::connectedComponentsWithStats(passed, labels, stats, centroids, 8);
  std::vector<int> pierced(static_cast<size_t>(pieces), 0);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      if (is_pierced(cells_[number_of(x, y)])) ++pierced[static_cast<size_t>(labels.at<int>(y, x))];
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const int piece = labels.at<int>(y, x);
      Cell& cell = cells_[number_of(x, y)];
      cell.open =
          piece > 0 && is_sunk(cell) &&
          pierced[static_cast<size_t>(piece)] > kRaster.min_pierced * stats.at<int>(piece, cv::CC_STAT_AREA);
    }
}

PlaneRaster::Cell* PlaneRaster::at(const Vector2d& map_point) {
  const Vector2d local = (axes_from_map_ * map_point - origin_) / cell_;
  const int x = static_cast<int>(std::floor(local.x()));
  const int y = static_cast<int>(std::floor(local.y()));
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return nullptr;
  return &cells_[number_of(x, y)];
}

void PlaneRaster::score_cells() {
  // Cells near surface, by an integral image.
  const int reach = static_cast<int>(kRaster.near_m / cell_);
  std::vector<int> sums(static_cast<size_t>(width_ + 1) * static_cast<size_t>(height_ + 1), 0);
  const auto sum_at = [&](int x, int y) -> int& {
    return sums[static_cast<size_t>(y) * static_cast<size_t>(width_ + 1) + static_cast<size_t>(x)];
  };
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      sum_at(x + 1, y + 1) =
          sum_at(x, y + 1) + sum_at(x + 1, y) - sum_at(x, y) + (is_support(cells_[number_of(x, y)]) ? 1 : 0);
  const auto near_support = [&](int x, int y) {
    const int x0 = std::max(0, x - reach);
    const int x1 = std::min(width_, x + reach + 1);
    const int y0 = std::max(0, y - reach);
    const int y1 = std::min(height_, y + reach + 1);
    return sum_at(x1, y1) - sum_at(x0, y1) - sum_at(x1, y0) + sum_at(x0, y0) > 0;
  };
  scores_.resize(cells_.size());
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Cell& cell = cells_[number_of(x, y)];
      scores_[number_of(x, y)] = cell.consumed         ? kRaster.consumed
                                 : is_support(cell)    ? kRaster.support
                                 : is_pierced(cell)    ? kRaster.pierced
                                 : is_sunk(cell)       ? kRaster.sunk
                                 : cell.uncertain > 0  ? kRaster.maybe
                                 : cell.shadow > 0     ? kRaster.hidden
                                 : !near_support(x, y) ? kRaster.unknown
                                 : cell.above > 0      ? kRaster.hidden
                                                       : kRaster.near;
    }
}

Extent PlaneRaster::best_rectangle(double* score) const {
  // Kadane's maximal sum over column sums between every pair of rows.
  float best = 0;
  int best_x0 = 0, best_x1 = -1, best_y0 = 0, best_y1 = -1;
  std::vector<float> columns(static_cast<size_t>(width_));
  for (int y0 = 0; y0 < height_; ++y0) {
    std::fill(columns.begin(), columns.end(), 0.0F);
    for (int y1 = y0; y1 < height_; ++y1) {
      float sum = 0;
      int start = 0;
      for (int x = 0; x < width_; ++x) {
        columns[static_cast<size_t>(x)] += scores_[number_of(x, y1)];
        if (sum <= 0) {
          sum = 0;
          start = x;
        }
        sum += columns[static_cast<size_t>(x)];
        if (sum > best) {
          best = sum;
          best_x0 = start;
          best_x1 = x;
          best_y0 = y0;
          best_y1 = y1;
        }
      }
    }
  }
  if (score != nullptr) *score = static_cast<double>(best) * cell_ * cell_;
  if (best_x1 < best_x0) return {};
  return {origin_ + cell_ * Vector2d(best_x0, best_y0), origin_ + cell_ * Vector2d(best_x1 + 1, best_y1 + 1)};
}

void PlaneRaster::consume(const Extent& extent) {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      if (extent.contains(origin_ + cell_ * Vector2d(x + 0.5, y + 0.5))) {
        cells_[number_of(x, y)].consumed = true;
        scores_[number_of(x, y)] = kRaster.consumed;
      }
}

PlaneRaster::Counts PlaneRaster::count(const Extent& extent) const {
  Counts counts;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      if (!extent.contains(origin_ + cell_ * Vector2d(x + 0.5, y + 0.5))) continue;
      const Cell& cell = cells_[number_of(x, y)];
      ++counts.cells;
      counts.rays += cell.pierced + cell.sunk;
      counts.support += is_support(cell) ? 1 : 0;
      counts.pierced += is_pierced(cell) ? 1 : 0;
      counts.sunk += is_sunk(cell) ? 1 : 0;
    }
  return counts;
}

double PlaneRaster::score_of(const std::vector<Vector2d>& polygon) const {
  std::vector<cv::Point2f> corners;
  for (const Vector2d& corner : polygon) {
    const Vector2d at = (axes_from_map_ * corner - origin_) / cell_;
    corners.emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()));
  }
  double sum = 0;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const cv::Point2f middle(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      if (cv::pointPolygonTest(corners, middle, false) >= 0)
        sum += static_cast<double>(scores_[number_of(x, y)]);
    }
  return sum * cell_ * cell_;
}

double PlaneRaster::score_outside(const Extent& extent, const std::vector<Extent>& others) const {
  const auto first = [&](int axis) {
    return std::max(0, static_cast<int>(std::ceil((extent.min[axis] - origin_[axis]) / cell_ - 0.5)));
  };
  const auto middle = [&](int x, int y) { return Vector2d(origin_ + cell_ * Vector2d(x + 0.5, y + 0.5)); };
  double sum = 0;
  for (int y = first(1); y < height_ && middle(0, y).y() <= extent.max.y(); ++y)
    for (int x = first(0); x < width_ && middle(x, y).x() <= extent.max.x(); ++x)
      if (std::ranges::none_of(others, [&](const Extent& other) { return other.contains(middle(x, y)); }))
        sum += static_cast<double>(scores_[number_of(x, y)]);
  return sum * cell_ * cell_;
}

std::vector<Vector2d> PlaneRaster::contour(const Extent& box) const {
  cv::Mat mask = cv::Mat::zeros(height_, width_, CV_8UC1);
  cv::Mat pierced = cv::Mat::zeros(height_, width_, CV_8UC1);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Cell& cell = cells_[number_of(x, y)];
      const bool near = box.contains(origin_ + cell_ * Vector2d(x + 0.5, y + 0.5), kRaster.contour_margin_m);
      if (near && is_support(cell)) mask.at<uint8_t>(y, x) = 255;
      if (is_pierced(cell)) pierced.at<uint8_t>(y, x) = 255;
    }
  const int reach = static_cast<int>(std::lround(kRaster.closed_gap_m / cell_ / 2));
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1});
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, kernel);
  mask.setTo(0, pierced);
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  cv::resize(mask, mask, {}, kRaster.contour_scale, kRaster.contour_scale, cv::INTER_NEAREST);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto largest = std::max_element(contours.begin(), contours.end(), [](const auto& a, const auto& b) {
    return cv::contourArea(a) < cv::contourArea(b);
  });
  std::vector<Vector2d> boundary;
  if (largest == contours.end()) return boundary;
  for (const cv::Point& at : *largest)
    boundary.push_back(axes_from_map_.inverse() *
                       (origin_ + cell_ / kRaster.contour_scale * Vector2d(at.x + 0.5, at.y + 0.5)));
  return boundary;
}

}  // namespace loci::mapping
