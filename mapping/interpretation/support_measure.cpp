#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "mapping/base/quantile.h"
#include "mapping/interpretation/edge_position.h"
#include "mapping/interpretation/support_checks.h"

namespace loci::mapping {
namespace {

constexpr double kStrip = 0.02;    // m; an edge is looked at strip by strip
constexpr double kInside = 0.06;   // m; how far inside the raster's edge the true one may lie
constexpr double kOutside = 0.05;  // m; and outside
constexpr double kSnap = 0.12;     // m; an unseen edge this near a wall ends at the wall
constexpr size_t kMinPoints = 30;  // of a scan that has a say about the height

/// One side of a rectangle: its axis (0 = x, 1 = y) and whether it is the upper end.
struct Side {
  int axis;
  bool upper;

  static Side of(size_t number) { return {static_cast<int>(number / 2), number % 2 == 1}; }
  double sign() const { return upper ? 1 : -1; }
  double& edge(Extent& extent) const { return upper ? extent.max[axis] : extent.min[axis]; }
};

/// Where the surface ends at a side: each scan says, by the typical outermost point of the strips in which it
/// saw the end; the median over the scans counts.
void refine_edge(Extent& extent, Side side, const std::vector<PlaneEvidence::SupportPoint>& points) {
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
    if (value < edge - 2 * kInside || value > edge + kOutside) continue;
    Outermost& strip = strips[point.scan][static_cast<int>(std::floor(point.position[across] / kStrip))];
    strip.value = std::max(strip.value, value);
    ++strip.count;
  }
  constexpr size_t kMinStrips = 6;
  std::vector<double> opinions;
  for (const auto& [scan, along] : strips) {
    std::vector<double> ends;
    for (const auto& [strip, outermost] : along)
      if (outermost.count >= 3 && outermost.value > edge - kInside) ends.push_back(outermost.value);
    if (ends.size() >= kMinStrips) opinions.push_back(quantile(ends, 0.6));
  }
  if (!opinions.empty()) side.edge(extent) = side.sign() * median(opinions);
}

/// Near to where a surface meets or becomes a vertical one, normals do not tell: it goes on as long as points
/// at its height lie about as densely as inside.
void grow_edge(Extent& extent, Side side, const std::vector<PlaneEvidence::SupportPoint>& support,
               const std::vector<PlaneEvidence::SupportPoint>& brink) {
  constexpr double kBin = 0.005;   // m
  constexpr double kInner = 0.06;  // m inside the edge, with which the density is compared
  constexpr double kDense = 0.5;
  const int across = 1 - side.axis;
  const double edge = side.sign() * side.edge(extent);
  std::array<double, static_cast<size_t>(kOutside / kBin)> beyond{};
  double inside = 0;
  for (const auto* points : {&support, &brink})
    for (const auto& point : *points) {
      if (point.position[across] < extent.min[across] || point.position[across] > extent.max[across])
        continue;
      const double bin = std::floor((side.sign() * point.position[side.axis] - edge) / kBin);
      if (bin < 0 && bin >= -kInner / kBin) inside += kBin / kInner;
      if (bin >= 0 && bin < static_cast<double>(beyond.size())) ++beyond[static_cast<size_t>(bin)];
    }
  size_t bins = 0;
  while (bins < beyond.size() && inside > 0 && beyond[bins] >= kDense * inside) ++bins;
  side.edge(extent) += side.sign() * kBin * static_cast<double>(bins);
}

/// A free edge by what shows it best.
void sharpen_edge(Extent& extent, Side side, const PlaneEvidence& evidence,
                  const Eigen::Rotation2Dd& axes_from_map) {
  constexpr double kInset = 0.03;  // m from the corners
  const int across = 1 - side.axis;
  double& edge = side.edge(extent);
  const EdgeSamples samples = samples_across(evidence, [&](const Vector2d& map_point) {
    const Vector2d at = axes_from_map * map_point;
    const bool beside = at[across] < extent.min[across] + kInset || at[across] > extent.max[across] - kInset;
    return beside ? 1e9 : side.sign() * (at[side.axis] - edge);
  });
  if (const auto shift = edge_position(samples, extent.size()[across])) edge += side.sign() * *shift;
}

Extent strip_outside(const Extent& extent, Side side) {
  Extent strip = extent;
  const double edge = side.upper ? extent.max[side.axis] : extent.min[side.axis];
  strip.min[side.axis] = edge + (side.upper ? 0.02 : -0.08);
  strip.max[side.axis] = edge + (side.upper ? 0.08 : -0.02);
  return strip;
}

/// Distance from a side to the nearest wall parallel to it and beside it; negative = the side is behind it.
double distance_to_wall(const Support& support, const Extent& extent, Side side,
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
  std::vector<PlaneEvidence::SupportPoint> brink = evidence.brink;
  const Eigen::Rotation2Dd axes_from_map(-support.yaw);
  for (auto* list : {&points, &brink})
    for (auto& point : *list) point.position = axes_from_map * point.position;
  for (size_t number = 0; number < support.parts.size(); ++number) {
    Extent& part = support.parts[number];
    for (size_t i = 0; i < 4; ++i) refine_edge(part, Side::of(i), points);
    for (size_t i = 0; i < 4; ++i) grow_edge(part, Side::of(i), points, brink);
    for (size_t i = 0; i < 4; ++i) sharpen_edge(part, Side::of(i), evidence, axes_from_map);
    for (size_t i = 0; i < 4; ++i) {
      const Side side = Side::of(i);
      int wall = -1;
      const PlaneRaster::Counts outside = raster.count(strip_outside(part, side));
      // Many cells with rays, or, where rays are sparse, many rays.
      const bool passed =
          outside.pierced + outside.sunk > 0.3 * outside.cells || outside.rays > 0.7 * outside.cells;
      EdgeKind kind = passed ? EdgeKind::free : EdgeKind::unseen;
      const double distance = distance_to_wall(support, part, side, walls, wall);
      if (distance < kSnap && (kind == EdgeKind::unseen || distance < 0.04)) {
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
  const Eigen::Rotation2Dd axes_from_map(-support.yaw);
  std::map<uint16_t, std::vector<double>> heights;
  for (const auto& point : evidence.support) {
    const Vector2d at = axes_from_map * point.position;
    const bool inside = std::any_of(support.parts.begin(), support.parts.end(),
                                    [&](const Extent& part) { return part.contains(at, -0.01); });
    if (!inside) continue;
    heights[point.scan].push_back(static_cast<double>(point.height));
    ++support.inliers;
  }
  size_t most = 0;
  for (const auto& [scan, values] : heights) most = std::max(most, values.size());
  std::vector<double> medians;
  for (const auto& [scan, values] : heights) {
    if (values.size() < std::min(most, std::max(kMinPoints, most / 20))) continue;
    support.scans.push_back(scan);
    medians.push_back(median(values));
  }
  if (medians.empty()) return;
  support.height = median(medians);
  double squares = 0;
  for (const double value : medians) squares += (value - support.height) * (value - support.height);
  support.sd = std::sqrt(squares / static_cast<double>(medians.size()));
}

/// Fraction of the footprint under which rays passed, or surfaces were seen, at about half the height.
double fraction_seen_below(const Support& support, const Surface& surface) {
  const Extent& part = support.parts.front();
  constexpr double kCell = 0.05;
  const double inset = std::min(0.1, part.size().minCoeff() / 4);
  const Vector2d size = part.size().array() - 2 * inset;
  const auto columns = static_cast<size_t>(size.x() / kCell) + 1;
  const auto rows = static_cast<size_t>(size.y() / kCell) + 1;
  std::vector<int> seen(columns * rows, 0);
  const Eigen::Rotation2Dd axes_from_map(-support.yaw);
  const auto mark = [&](const Vector2d& map_point) {
    const Vector2d local = (axes_from_map * map_point - part.min).array() - inset;
    if ((local.array() < 0).any()) return;
    const auto column = static_cast<size_t>(local.x() / kCell);
    const auto row = static_cast<size_t>(local.y() / kCell);
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
