#include "mapping/exchange/comparison/compare.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/exchange/comparison/compare_furniture.h"

namespace loci::mapping {
namespace {

struct Bounds {
  Vector2d min = Vector2d::Constant(1e9);
  Vector2d max = Vector2d::Constant(-1e9);
};

Bounds bounds_of(const SurfacePatch& patch, double yaw) {
  Bounds bounds;
  const Eigen::Rotation2Dd axes_from_map(-yaw);
  for (const auto& polygon : patch.polygons)
    for (const Vector2d& corner : polygon) {
      const Vector2d at = axes_from_map * corner;
      bounds.min = bounds.min.cwiseMin(at);
      bounds.max = bounds.max.cwiseMax(at);
    }
  return bounds;
}

/// Direction of the longest edge, modulo 90°, nearest to the map's axes.
double yaw_of(const SurfacePatch& patch) {
  double longest = 0;
  double yaw = 0;
  for (const auto& polygon : patch.polygons)
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
      const double angle = std::remainder(std::atan2(edge.y(), edge.x()), kPi / 2);
      if (edge.norm() <= longest + 1e-6) continue;
      longest = edge.norm();
      yaw = angle;
    }
  // The diagonal of a triangulated rectangle is its longest edge; a patch of triangles is taken in the map's
  // axes.
  return patch.polygons.size() > 1 ? 0 : yaw;
}

cv::Mat mask_of(const SurfacePatch& patch, const Bounds& bounds, double cell) {
  const Vector2d size = (bounds.max - bounds.min) / cell;
  cv::Mat mask = cv::Mat::zeros(static_cast<int>(size.y()) + 3, static_cast<int>(size.x()) + 3, CV_8UC1);
  for (const auto& polygon : patch.polygons) {
    std::vector<cv::Point> corners;
    for (const Vector2d& corner : polygon) {
      const Vector2d at = (corner - bounds.min) / cell;
      corners.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    }
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255));
  }
  return mask;
}

ComparedElement compared(const SurfacePatch& map, const SurfacePatch& truth, double overlap) {
  ComparedElement element;
  element.kind = "support";
  element.verdict = truth.main ? "matched" : "minor";
  element.map_name = map.name;
  element.truth_name = truth.name;
  element.height_error = map.height - truth.height;
  element.overlap = overlap;
  const double yaw = yaw_of(truth);
  const Bounds a = bounds_of(map, yaw);
  const Bounds b = bounds_of(truth, yaw);
  element.edge_errors = {a.min.x() - b.min.x(), a.max.x() - b.max.x(), a.min.y() - b.min.y(),
                         a.max.y() - b.max.y()};
  return element;
}

void compare_supports(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options,
                      Comparison& result) {
  struct Pair {
    size_t map, truth;
    double overlap;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < map.supports.size(); ++i)
    for (size_t j = 0; j < truth.supports.size(); ++j) {
      if (std::abs(map.supports[i].height - truth.supports[j].height) > options.height_tolerance_m) continue;
      const double overlap = overlap_of(map.supports[i], truth.supports[j]);
      if (overlap >= options.min_outline_overlap) pairs.push_back({i, j, overlap});
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap > b.overlap; });
  std::vector<bool> map_used(map.supports.size(), false);
  std::vector<bool> truth_used(truth.supports.size(), false);
  for (const Pair& pair : pairs) {
    if (map_used[pair.map] || truth_used[pair.truth]) continue;
    map_used[pair.map] = truth_used[pair.truth] = true;
    result.elements.push_back(compared(map.supports[pair.map], truth.supports[pair.truth], pair.overlap));
  }
  const auto lone = [&](const std::string& verdict, const std::string& map_name,
                        const std::string& truth_name) {
    ComparedElement element;
    element.kind = "support";
    element.verdict = verdict;
    element.map_name = map_name;
    element.truth_name = truth_name;
    result.elements.push_back(element);
  };
  for (size_t j = 0; j < truth.supports.size(); ++j)
    if (!truth_used[j] && truth.supports[j].main && asked_for(truth.supports[j].region, options))
      lone(truth.supports[j].height > options.observable_height_m ? "not observable" : "missed", "",
           truth.supports[j].name);
  for (size_t i = 0; i < map.supports.size(); ++i)
    if (!map_used[i]) lone("extra", map.supports[i].name, "");
}

/// Shared length of two walls over the shorter one's, and their differences in the middle of the map's wall.
std::optional<ComparedElement> compared(const WallPatch& map, const WallPatch& truth,
                                        const ComparisonOptions& options) {
  const double cosine = std::clamp(map.normal.dot(truth.normal), -1.0, 1.0);
  const double angle = std::acos(cosine) / kDegree;
  if (angle > options.wall_angle_deg) return std::nullopt;
  const Vector3d direction(-map.normal.y(), map.normal.x(), 0);
  const Vector3d middle = map.offset * map.normal + (map.along_min + map.along_max) / 2 * direction;
  const double offset = truth.normal.dot(middle) - truth.offset;
  if (std::abs(offset) > options.wall_tolerance_m) return std::nullopt;
  const double shared = std::min(map.along_max, truth.along_max) - std::max(map.along_min, truth.along_min);
  const double shorter = std::min(map.along_max - map.along_min, truth.along_max - truth.along_min);
  if (shared < 0.3 * shorter) return std::nullopt;
  ComparedElement element;
  element.kind = "wall";
  element.verdict = truth.main ? "matched" : "minor";
  element.map_name = map.name;
  element.truth_name = truth.name;
  element.offset_error = offset;
  element.angle_error_deg = angle;
  return element;
}

/// Whether nearly all of a wall's length is within another's.
bool covers(const WallPatch& wall, const WallPatch& piece) {
  const double shared = std::min(wall.along_max, piece.along_max) - std::max(wall.along_min, piece.along_min);
  return shared > 0.9 * (piece.along_max - piece.along_min);
}

void compare_walls(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options,
                   Comparison& result) {
  std::vector<bool> found(truth.walls.size(), false);
  for (const WallPatch& wall : map.walls) {
    std::optional<ComparedElement> best;
    size_t best_truth = 0;
    for (size_t j = 0; j < truth.walls.size(); ++j) {
      const auto element = compared(wall, truth.walls[j], options);
      if (!element) continue;
      const bool better = !best || (truth.walls[j].main && best->verdict == "minor") ||
                          (element->verdict == best->verdict &&
                           std::abs(*element->offset_error) < std::abs(*best->offset_error));
      if (!better) continue;
      best = element;
      best_truth = j;
    }
    if (!best) {
      best.emplace();
      best->kind = "wall";
      best->verdict = "extra";
      best->map_name = wall.name;
    } else {
      if (found[best_truth]) best->verdict = "minor";  // a further piece of a wall that is counted already
      found[best_truth] = true;
    }
    result.elements.push_back(*best);
  }
  for (size_t j = 0; j < truth.walls.size(); ++j) {
    if (found[j] || !truth.walls[j].main || !asked_for(truth.walls[j].region, options)) continue;
    // One wall of the map may go on behind a passage, as the next one of the truth.
    std::optional<ComparedElement> piece;
    for (const WallPatch& wall : map.walls)
      if (!piece && covers(wall, truth.walls[j])) piece = compared(wall, truth.walls[j], options);
    if (piece) {
      result.elements.push_back(*piece);
      continue;
    }
    ComparedElement element;
    element.kind = "wall";
    element.verdict = "missed";
    element.truth_name = truth.walls[j].name;
    result.elements.push_back(element);
  }
}

}  // namespace

void ComparisonOptions::declare(OptionTable& table) {
  table.number("height_tolerance_m", height_tolerance_m, "m",
               "Supports match when their heights differ by no more.", 0.001, 1);
  table.number("min_outline_overlap", min_outline_overlap, "",
               "Least intersection over union of matching outlines.", 0.01, 1);
  table.number("wall_tolerance_m", wall_tolerance_m, "m", "Walls match when their planes differ by no more.",
               0.001, 1);
  table.number("wall_angle_deg", wall_angle_deg, "deg", "Walls match when their normals differ by no more.",
               0.1, 45);
  table.number("handle_tolerance_m", handle_tolerance_m, "m",
               "Handles match when their centres are no further apart.", 0.001, 1);
  table.number("observable_height_m", observable_height_m, "m",
               "Supports above this height that the map lacks are not observable rather than missed.", 0,
               100);
  table.text("region", region, "Asks only for elements of this region of the truth; empty = all.");
}

double overlap_of(const SurfacePatch& a, const SurfacePatch& b) {
  constexpr double kCell = 0.005;
  const Bounds of_a = bounds_of(a, 0);
  const Bounds of_b = bounds_of(b, 0);
  if ((of_a.min.array() > of_b.max.array()).any() || (of_b.min.array() > of_a.max.array()).any()) return 0;
  const Bounds both{of_a.min.cwiseMin(of_b.min), of_a.max.cwiseMax(of_b.max)};
  const cv::Mat mask_a = mask_of(a, both, kCell);
  const cv::Mat mask_b = mask_of(b, both, kCell);
  cv::Mat shared, united;
  cv::bitwise_and(mask_a, mask_b, shared);
  cv::bitwise_or(mask_a, mask_b, united);
  const int area = cv::countNonZero(united);
  return area == 0 ? 0 : static_cast<double>(cv::countNonZero(shared)) / area;
}

Comparison compare(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options) {
  ComparisonOptions checked = options;
  table_of(checked).validate({"", 0, "compare"});
  Comparison result;
  result.map_source = map.source;
  result.truth_source = truth.source;
  compare_supports(map, truth, options, result);
  compare_walls(map, truth, options, result);
  compare_openings(map, truth, options, result);
  compare_furniture(map, truth, options, result);
  if (truth.floor_height) {
    ComparedElement floor;
    floor.kind = "floor";
    floor.verdict = map.floor_height ? "matched" : "missed";
    floor.truth_name = "floor";
    if (map.floor_height) {
      floor.map_name = "floor";
      floor.height_error = *map.floor_height - *truth.floor_height;
    }
    result.elements.push_back(floor);
  }
  return result;
}

}  // namespace loci::mapping
