#include "mapping/interpretation/surfaces/openings.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/parallel.h"
#include "mapping/interpretation/surfaces/parameters.h"
#include "mapping/interpretation/surfaces/plane_cells.h"

namespace loci::mapping {
namespace {

/// Cells in which rays passed through a wall (255) or ended on it (128).
cv::Mat1b pierced_cells(const PlaneCells& fine) {
  const auto n = static_cast<size_t>(kOpenings.fine_cells);
  cv::Mat1b cells(static_cast<int>(fine.rows() / n), static_cast<int>(fine.columns() / n), uchar{0});
  for (int row = 0; row < cells.rows; ++row)
    for (int column = 0; column < cells.cols; ++column) {
      int hits = 0, passes = 0;
      for (size_t i = 0; i < n * n; ++i) {
        const size_t x = static_cast<size_t>(column) * n + i % n, y = static_cast<size_t>(row) * n + i / n;
        hits += fine.hits(x, y);
        passes += fine.passes(x, y);
      }
      if (passes >= kWalls.min_rays && passes > hits)
        cells(row, column) = 255;
      else if (hits > 0)
        cells(row, column) = 128;
    }
  return cells;
}

/// Of the cells of a rectangle that are known, the share that has a value; 0 where less than a part is known.
double share_of(const cv::Mat1b& cells, const cv::Rect& rect, uchar value, double known_part) {
  const cv::Mat part = cells(rect & cv::Rect(0, 0, cells.cols, cells.rows));
  const int known = cv::countNonZero(part);
  if (part.empty() || known < known_part * static_cast<double>(rect.area())) return 0;
  return static_cast<double>(cv::countNonZero(part == value)) / known;
}

/// Without the outer rows and columns through which few rays passed.
cv::Rect trimmed(const cv::Mat1b& pierced, cv::Rect rect) {
  for (bool again = true; again && !rect.empty();) {
    again = false;
    const auto trim = [&](const cv::Rect& side, int x, int y, int width, int height) {
      if (cv::countNonZero(pierced(side)) > kOpenings.pierced_side * side.area()) return;
      rect += cv::Point(x, y);
      rect -= cv::Size(width, height);
      again = true;
    };
    trim({rect.x, rect.y, 1, rect.height}, 1, 0, 1, 0);
    if (!rect.empty()) trim({rect.x + rect.width - 1, rect.y, 1, rect.height}, 0, 0, 1, 0);
    if (!rect.empty()) trim({rect.x, rect.y, rect.width, 1}, 0, 1, 0, 1);
    if (!rect.empty()) trim({rect.x, rect.y + rect.height - 1, rect.width, 1}, 0, 0, 0, 1);
  }
  return rect;
}

/// Whether the wall was seen along a side, in the two cells beside it.
bool has_edge(const cv::Mat1b& cells, const cv::Rect& rect, const cv::Point& towards) {
  cv::Rect strip = rect;
  if (towards.x != 0) {
    strip.x = towards.x > 0 ? rect.x + rect.width : rect.x - kOpenings.edge_cells;
    strip.width = kOpenings.edge_cells;
  } else {
    strip.y = towards.y > 0 ? rect.y + rect.height : rect.y - kOpenings.edge_cells;
    strip.height = kOpenings.edge_cells;
  }
  return share_of(cells, strip, 128, kOpenings.known_edge) > kOpenings.solid_edge;
}

/// Where rays cease to end on the wall and begin to pass it: the fine column or row, near a first guess, that
/// parts them best.
double edge_at(const std::vector<double>& hits, const std::vector<double>& passes, int guess,
               bool opens_after) {
  const int count = static_cast<int>(hits.size()), reach = 2 * kOpenings.fine_cells;
  const int first = std::max(0, guess - reach), last = std::min(count, guess + reach);
  double all_hits = 1e-9, all_passes = 1e-9;
  for (int i = first; i < last; ++i) {
    all_hits += hits[static_cast<size_t>(i)];
    all_passes += passes[static_cast<size_t>(i)];
  }
  double sum = 0, best = 0;
  int edge = first;
  for (int i = first; i < last; ++i) {
    const auto at = static_cast<size_t>(i);
    sum += (hits[at] / all_hits - passes[at] / all_passes) * (opens_after ? 1 : -1);
    if (sum > best) {
      best = sum;
      edge = i + 1;
    }
  }
  return best > 0 ? edge : guess;
}

/// The rectangle in metres, with sides found to a fine cell.
WallOpening refined(const PlaneCells& fine, const VerticalPlane& wall, const cv::Rect& cells) {
  const int n = kOpenings.fine_cells;
  const cv::Rect rect(cells.x * n, cells.y * n, cells.width * n, cells.height * n);
  const auto profile = [&](bool along, bool passes) {
    std::vector<double> sums(along ? fine.columns() : fine.rows(), 0);
    for (size_t y = 0; y < fine.rows(); ++y)
      for (size_t x = 0; x < fine.columns(); ++x) {
        const int across = static_cast<int>(along ? y : x), from = along ? rect.y : rect.x,
                  size = along ? rect.height : rect.width;
        if (across < from + n || across >= from + size - n) continue;
        sums[along ? x : y] += passes ? fine.passes(x, y) : fine.hits(x, y);
      }
    return sums;
  };
  const std::vector<double> hits = profile(true, false), passes = profile(true, true);
  const std::vector<double> high_hits = profile(false, false), high_passes = profile(false, true);
  WallOpening opening;
  opening.along_min = wall.along_min + kOpenings.fine_m * edge_at(hits, passes, rect.x, true);
  opening.along_max = wall.along_min + kOpenings.fine_m * edge_at(hits, passes, rect.x + rect.width, false);
  opening.bottom = wall.bottom + kOpenings.fine_m * edge_at(high_hits, high_passes, rect.y, true);
  opening.top = wall.bottom + kOpenings.fine_m * edge_at(high_hits, high_passes, rect.y + rect.height, false);
  return opening;
}

std::optional<WallOpening> opening_in(const PlaneCells& fine, const VerticalPlane& wall,
                                      const cv::Mat1b& cells, const cv::Rect& rect, double floor_height) {
  const double cell = kOpenings.fine_m * kOpenings.fine_cells;
  if (rect.width * cell < kOpenings.min_width_m || rect.height * cell < kOpenings.min_height_m)
    return std::nullopt;
  const double seen = share_of(cells, rect, 255, kOpenings.known_inside);
  if (seen < kOpenings.pierced_inside) return std::nullopt;
  // Passages between rooms have no lintel.
  const cv::Rect above(rect.x, rect.y + rect.height, rect.width, cells.rows - rect.y - rect.height);
  const bool passage = wall.bottom + cell * above.y > floor_height + kOpenings.min_passage_m &&
                       share_of(cells, above, 128, 0) < 1 - kOpenings.solid_edge;
  if (!has_edge(cells, rect, {-1, 0}) || !has_edge(cells, rect, {1, 0}) ||
      !(passage || has_edge(cells, rect, {0, 1})))
    return std::nullopt;
  WallOpening opening = refined(fine, wall, rect);
  opening.seen = seen;
  if (passage) opening.top = wall.top;
  // A threshold in shadow may hide the lowest part.
  const cv::Rect below(rect.x, 0, rect.width, rect.y);
  opening.doorway = opening.bottom < floor_height + kOpenings.max_threshold_m &&
                    share_of(cells, below, 128, 0) < 1 - kOpenings.solid_edge;
  if (opening.doorway)
    opening.bottom = floor_height;
  else if (passage || !has_edge(cells, rect, {0, -1}))
    return std::nullopt;
  return opening;
}

std::vector<WallOpening> openings_of(const Surface& surface, const VerticalPlane& wall, double floor_height) {
  PlaneCells fine(wall, kOpenings.fine_m, kOpenings.on_plane_m, kOpenings.on_plane_m);
  fine.add(surface);
  const cv::Mat1b cells = pierced_cells(fine);
  const cv::Mat1b pierced(cells == 255);
  cv::Mat labels, boxes, centroids;
  const int count = cv::connectedComponentsWithStats(pierced, labels, boxes, centroids, 4);
  std::vector<WallOpening> openings;
  for (int i = 1; i < count; ++i) {
    const cv::Rect box(boxes.at<int>(i, cv::CC_STAT_LEFT), boxes.at<int>(i, cv::CC_STAT_TOP),
                       boxes.at<int>(i, cv::CC_STAT_WIDTH), boxes.at<int>(i, cv::CC_STAT_HEIGHT));
    if (const auto opening = opening_in(fine, wall, cells, trimmed(pierced, box), floor_height))
      openings.push_back(*opening);
  }
  std::ranges::sort(openings, {}, &WallOpening::along_min);
  return openings;
}

}  // namespace

std::vector<std::vector<WallOpening>> find_openings(const Surface& surface,
                                                    const std::vector<VerticalPlane>& walls,
                                                    double floor_height, int threads) {
  std::vector<std::vector<WallOpening>> openings(walls.size());
  if (!surface.free_space) return openings;
  parallel_for(walls.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) openings[i] = openings_of(surface, walls[i], floor_height);
  });
  return openings;
}

}  // namespace loci::mapping
