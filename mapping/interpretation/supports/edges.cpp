#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/refinement.h"
#include "mapping/interpretation/surfaces/levelling.h"

namespace loci::mapping {
namespace {

/// The slab's vertical edge: the peak of the points right below the top.
std::optional<double> rim_position(std::vector<double> rim, double length) {
  std::sort(rim.begin(), rim.end());
  size_t max_count = 0;
  double peak = 0;
  for (double at = -kEdges.window_m; at < kEdges.window_m; at += kEdges.rim_bin_m) {
    const auto count = static_cast<size_t>(std::upper_bound(rim.begin(), rim.end(), at + kEdges.rim_half_m) -
                                           std::lower_bound(rim.begin(), rim.end(), at - kEdges.rim_half_m));
    if (count <= max_count) continue;
    max_count = count;
    peak = at;
  }
  const double density = static_cast<double>(max_count) / (2 * kEdges.rim_half_m);
  const double others =
      static_cast<double>(rim.size() - max_count) / (2 * (kEdges.window_m - kEdges.rim_half_m));
  if (static_cast<double>(max_count) < kEdges.min_rim_per_m * length ||
      density < kEdges.rim_contrast * others)
    return std::nullopt;
  return median(std::vector<double>(std::lower_bound(rim.begin(), rim.end(), peak - kEdges.rim_half_m),
                                    std::upper_bound(rim.begin(), rim.end(), peak + kEdges.rim_half_m)));
}

/// The line that separates surface from rays that passed beside it.
std::optional<double> separating_position(const EdgeSamples& samples, double length) {
  const auto enough = [&](const std::vector<double>& list) {
    return static_cast<double>(list.size()) > kEdges.min_split_per_m * length;
  };
  if (!enough(samples.support) || !enough(samples.passed)) return std::nullopt;
  size_t min_errors = SIZE_MAX;
  std::vector<double> best;
  for (double at = -kEdges.window_m; at <= kEdges.window_m; at += kEdges.split_step_m) {
    const auto errors = static_cast<size_t>(
        std::count_if(samples.support.begin(), samples.support.end(), [&](double v) { return v > at; }) +
        std::count_if(samples.passed.begin(), samples.passed.end(), [&](double v) { return v < at; }));
    if (errors < min_errors) best.clear();
    if (errors <= min_errors) best.push_back(at);
    min_errors = std::min(min_errors, errors);
  }
  if (10 * min_errors > samples.support.size() + samples.passed.size()) return std::nullopt;
  return median(best);
}

/// Whether the top was seen about as densely in the strip by which an edge would grow as inside.
bool surface_reaches(const EdgeSamples& samples, double position) {
  if (position < kEdges.small_growth_m) return true;
  const auto between = [&](double low, double high) {
    const auto inside = [&](double v) { return v >= low && v < high; };
    return static_cast<double>(std::ranges::count_if(samples.support, inside) +
                               std::ranges::count_if(samples.uncertain, inside));
  };
  return between(0, position) / position >=
         kEdges.growth_density * between(-kEdges.window_m, 0) / kEdges.window_m;
}

}  // namespace

std::optional<double> edge_position(const EdgeSamples& samples, double length) {
  auto position = rim_position(samples.rim, length);
  if (!position) position = separating_position(samples, length);
  return position && surface_reaches(samples, *position) ? position : std::nullopt;
}

namespace {

/// One side of a rectangle: its axis (0 = x, 1 = y) and whether it is the upper end.
struct RectangleSide {
  int axis;
  bool upper;

  static RectangleSide of(size_t number) { return {static_cast<int>(number / 2), number % 2 == 1}; }
  double sign() const { return upper ? 1 : -1; }
  double& edge(Extent& extent) const { return upper ? extent.max[axis] : extent.min[axis]; }
};

/// Moves a side to the median, over scans, of the typical outermost point per strip.
void refine_edge(Extent& extent, RectangleSide side, const std::vector<PlaneEvidence::SupportPoint>& points) {
  const int across = 1 - side.axis;
  const double edge = side.sign() * side.edge(extent);
  struct Outermost {
    double value = -1e9;
    int count = 0;
  };
  std::map<uint16_t, std::map<int, Outermost>> strips;  // scan → strip
  for (const auto& point : points) {
    if (point.position[across] < extent.min[across] || point.position[across] > extent.max[across]) continue;
    const double value = side.sign() * point.position[side.axis];
    if (value < edge - 2 * kEdges.inside_m || value > edge + kEdges.outside_m) continue;
    Outermost& strip =
        strips[point.scan][static_cast<int>(std::floor(point.position[across] / kEdges.strip_m))];
    strip.value = std::max(strip.value, value);
    ++strip.count;
  }
  std::vector<double> ends_by_scan;
  for (const auto& [scan, along] : strips) {
    std::vector<double> ends;
    for (const auto& [strip, outermost] : along)
      if (outermost.count >= 3 && outermost.value > edge - kEdges.inside_m) ends.push_back(outermost.value);
    if (ends.size() >= kEdges.min_strips) ends_by_scan.push_back(quantile(ends, 0.6));
  }
  if (!ends_by_scan.empty()) side.edge(extent) = side.sign() * median(ends_by_scan);
}

/// Near vertical surfaces normals are unreliable: extends the surface as long as points at its height are
/// about as dense as inside.
void grow_edge(Extent& extent, RectangleSide side, const std::vector<PlaneEvidence::SupportPoint>& support,
               const std::vector<PlaneEvidence::SupportPoint>& uncertain) {
  const int across = 1 - side.axis;
  const double edge = side.sign() * side.edge(extent);
  std::array<double, static_cast<size_t>(kEdges.outside_m / kEdges.bin_m)> beyond{};
  double inside = 0;
  for (const auto* points : {&support, &uncertain})
    for (const auto& point : *points) {
      if (point.position[across] < extent.min[across] || point.position[across] > extent.max[across])
        continue;
      const double bin = std::floor((side.sign() * point.position[side.axis] - edge) / kEdges.bin_m);
      if (bin < 0 && bin >= -kEdges.inner_m / kEdges.bin_m) inside += kEdges.bin_m / kEdges.inner_m;
      if (bin >= 0 && bin < static_cast<double>(beyond.size())) ++beyond[static_cast<size_t>(bin)];
    }
  size_t bins = 0;
  while (bins < beyond.size() && inside > 0 && beyond[bins] >= kEdges.dense * inside) ++bins;
  side.edge(extent) += side.sign() * kEdges.bin_m * static_cast<double>(bins);
}

void sharpen_edge(Extent& extent, RectangleSide side, const PlaneEvidence& evidence,
                  const Eigen::Rotation2Dd& axes_from_map) {
  const int across = 1 - side.axis;
  double& edge = side.edge(extent);
  const EdgeSamples samples = samples_across(evidence, [&](const Vector2d& map_point) {
    const Vector2d at = axes_from_map * map_point;
    const bool beside = at[across] < extent.min[across] + kEdges.corner_inset_m ||
                        at[across] > extent.max[across] - kEdges.corner_inset_m;
    return beside ? 1e9 : side.sign() * (at[side.axis] - edge);
  });
  if (const auto shift = edge_position(samples, extent.size()[across])) edge += side.sign() * *shift;
}

Extent strip_beyond(const Extent& extent, RectangleSide side) {
  Extent strip = extent;
  const double edge = side.upper ? extent.max[side.axis] : extent.min[side.axis];
  strip.min[side.axis] = edge + (side.upper ? 0.02 : -0.08);
  strip.max[side.axis] = edge + (side.upper ? 0.08 : -0.02);
  return strip;
}

/// Distance from a side to the nearest wall parallel to it and beside it; negative = the side is behind it.
double distance_to_wall(const Support& support, const Extent& extent, RectangleSide side,
                        const std::vector<VerticalPlane>& walls, int& nearest) {
  Vector2d outward = Vector2d::Zero();
  outward[side.axis] = side.sign();
  outward = support.map_from_axes() * outward;
  Vector2d middle = extent.centre();
  middle[side.axis] = side.upper ? extent.max[side.axis] : extent.min[side.axis];
  middle = support.map_from_axes() * middle;
  double best = 1e9;
  for (size_t i = 0; i < walls.size(); ++i) {
    const VerticalPlane& wall = walls[i];
    if (wall.normal.dot(outward) > -0.97) continue;
    const double along = wall.direction().dot(middle);
    if (along < wall.along_min - 0.3 || along > wall.along_max + 0.3) continue;
    const double distance = wall.normal.dot(middle) - wall.offset;
    if (distance > -0.1 && distance < best) {
      best = distance;
      nearest = static_cast<int>(i);
    }
  }
  return best;
}

void measure_edges(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster,
                   const std::vector<VerticalPlane>& walls) {
  std::vector<PlaneEvidence::SupportPoint> points = evidence.support;
  std::vector<PlaneEvidence::SupportPoint> uncertain = evidence.uncertain;
  const Eigen::Rotation2Dd axes_from_map(-support.yaw);
  for (auto* list : {&points, &uncertain})
    for (auto& point : *list) point.position = axes_from_map * point.position;
  for (size_t number = 0; number < support.parts.size(); ++number) {
    Extent& part = support.parts[number];
    for (size_t i = 0; i < 4; ++i) refine_edge(part, RectangleSide::of(i), points);
    for (size_t i = 0; i < 4; ++i) grow_edge(part, RectangleSide::of(i), points, uncertain);
    for (size_t i = 0; i < 4; ++i) sharpen_edge(part, RectangleSide::of(i), evidence, axes_from_map);
    for (size_t i = 0; i < 4; ++i) {
      const RectangleSide side = RectangleSide::of(i);
      int wall = -1;
      const PlaneRaster::Counts outside = raster.count(strip_beyond(part, side));
      // Many cells with rays or, where rays are sparse, many rays.
      const bool passed =
          outside.pierced + outside.sunk > 0.3 * outside.cells || outside.rays > 0.7 * outside.cells;
      EdgeKind kind = passed ? EdgeKind::free : EdgeKind::unseen;
      const double distance = distance_to_wall(support, part, side, walls, wall);
      if (distance < kEdges.snap_m && (kind == EdgeKind::unseen || distance < 0.04)) {
        kind = EdgeKind::wall;
        side.edge(part) += side.sign() * distance;
      }
      if (number == 0) support.edges[i] = kind;
      if (distance < support.wall_distance) {
        support.wall_distance = std::max(0.0, kind == EdgeKind::wall ? 0.0 : distance);
        support.wall = wall;
      }
    }
  }
}

void measure_height(Support& support, const PlaneEvidence& evidence) {
  std::map<uint16_t, std::vector<double>> heights;
  for (const auto& point : evidence.support) {
    if (!support.contains(point.position, -0.01)) continue;
    heights[point.scan].push_back(static_cast<double>(point.height));
    ++support.inliers;
  }
  size_t max_points = 0;
  for (const auto& [scan, values] : heights) max_points = std::max(max_points, values.size());
  const auto level =
      level_height(heights, std::min(max_points, std::max(kEdges.min_scan_points, max_points / 20)));
  if (!level) return;
  support.height = level->height;
  support.sd = level->sd;
  support.scans = level->scans;
}

/// Fraction of the footprint under which rays passed at half the height.
double fraction_seen_below(const Support& support, const Surface& surface) {
  const Extent& part = support.parts.front();
  const double inset = std::min(0.1, part.size().minCoeff() / 4);
  const Vector2d size = part.size().array() - 2 * inset;
  const auto columns = static_cast<size_t>(size.x() / kEdges.below_cell_m) + 1;
  const auto rows = static_cast<size_t>(size.y() / kEdges.below_cell_m) + 1;
  std::vector<int> seen(columns * rows, 0);
  const Eigen::Rotation2Dd axes_from_map(-support.yaw);
  const auto mark = [&](const Vector2d& map_point) {
    const Vector2d local = (axes_from_map * map_point - part.min).array() - inset;
    if ((local.array() < 0).any()) return;
    const auto column = static_cast<size_t>(local.x() / kEdges.below_cell_m);
    const auto row = static_cast<size_t>(local.y() / kEdges.below_cell_m);
    if (column < columns && row < rows) ++seen[row * columns + column];
  };
  const double level = support.height / 2;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d end = point.position.cast<double>();
    if (end.z() > level || !surface.free_space) continue;
    const Vector3d origin = surface.origins[point.origin].cast<double>();
    if (origin.z() > level)
      mark((origin + (end - origin) * ((origin.z() - level) / (origin.z() - end.z()))).head<2>());
  }
  const auto count = std::count_if(seen.begin(), seen.end(), [](int rays) { return rays >= 2; });
  return static_cast<double>(count) / static_cast<double>(seen.size());
}

}  // namespace

void measure(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster,
             const std::vector<VerticalPlane>& walls, const Surface& surface) {
  measure_edges(support, evidence, raster, walls);
  measure_height(support, evidence);
  const double cell_area = raster.cell() * raster.cell();
  for (const Extent& part : support.parts) {
    const PlaneRaster::Counts counts = raster.count(part);
    support.observed_area += counts.support * cell_area;
    support.pierced_area += counts.pierced * cell_area;
  }
  support.seen_below = fraction_seen_below(support, surface);
}

}  // namespace loci::mapping
