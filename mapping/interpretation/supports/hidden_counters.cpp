#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/refinement.h"

namespace loci::mapping {
namespace {

/// A level piece of a face's upper edge.
struct LevelTop {
  double height = 0;
  double overhang = 0;  ///< of the slab before the face, metres
  double along_min = 0, along_max = 0;
};

std::optional<LevelTop> level_top(const Surface& surface, const VerticalPlane& face) {
  std::map<int, std::vector<float>> columns;
  const Vector2d direction = face.direction();
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    if (std::abs(face.normal.dot(position.head<2>()) - face.offset) > 0.05) continue;
    const double along = direction.dot(position.head<2>());
    if (along < face.along_min || along > face.along_max || position.z() > face.top + 0.03) continue;
    if (std::abs(point.normal.z()) > 0.5F) continue;
    columns[static_cast<int>(std::floor(along / kHiddenCounters.column_m))].push_back(point.position.z());
  }
  std::vector<double> tops;
  std::vector<int> numbers;
  for (auto& [number, heights] : columns) {
    if (heights.size() < 10) continue;
    tops.push_back(static_cast<double>(quantile(heights, 0.97)));
    numbers.push_back(number);
  }
  if (tops.size() < 8) return std::nullopt;
  LevelTop top{median(tops), 1e9, -1e9};
  size_t level = 0;
  for (size_t i = 0; i < tops.size(); ++i) {
    if (std::abs(tops[i] - top.height) > kHiddenCounters.level_m) continue;
    ++level;
    top.along_min = std::min(top.along_min, numbers[i] * kHiddenCounters.column_m);
    top.along_max = std::max(top.along_max, (numbers[i] + 1) * kHiddenCounters.column_m);
  }
  if (static_cast<double>(level) < kHiddenCounters.min_level * static_cast<double>(tops.size()))
    return std::nullopt;
  if (top.along_min < face.along_min + kHiddenCounters.end_gap_m) top.along_min = face.along_min;
  if (top.along_max > face.along_max - kHiddenCounters.end_gap_m) top.along_max = face.along_max;
  return top;
}

/// How far the slab protrudes from the face: the typical outermost point of a column near the top.
double overhang(const Surface& surface, const VerticalPlane& face, const LevelTop& top) {
  std::map<int, double> outermost;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    if (std::abs(position.z() - top.height) > 0.05) continue;
    const double before = face.normal.dot(position.head<2>()) - face.offset;
    const double along = face.direction().dot(position.head<2>());
    if (before < 0 || before > kHiddenCounters.max_overhang_m || along < top.along_min ||
        along > top.along_max)
      continue;
    double& max_before = outermost[static_cast<int>(std::floor(along / kHiddenCounters.column_m))];
    max_before = std::max(max_before, before);
  }
  if (outermost.empty()) return 0;
  std::vector<double> values;
  for (const auto& [column, value] : outermost) values.push_back(value);
  return median(values);
}

/// The wall behind a face: parallel within 10°, at the depth of furniture.
int wall_behind(const VerticalPlane& face, const LevelTop& top, const std::vector<VerticalPlane>& walls,
                double& depth) {
  const Vector2d middle = face.at((top.along_min + top.along_max) / 2);
  int best = -1;
  depth = kHiddenCounters.max_depth_m;
  for (size_t i = 0; i < walls.size(); ++i) {
    const VerticalPlane& wall = walls[i];
    if (wall.normal.dot(face.normal) < 0.985) continue;
    const double along = wall.direction().dot(middle);
    if (along < wall.along_min - 0.5 || along > wall.along_max + 0.5) continue;
    const double distance = wall.normal.dot(middle) - wall.offset;
    if (distance < kHiddenCounters.min_depth_m || distance > depth) continue;
    depth = distance;
    best = static_cast<int>(i);
  }
  return best;
}

/// The rectangle from the face to the wall, x outwards.
Support between(const VerticalPlane& face, const LevelTop& top, double depth) {
  Support support;
  support.yaw = std::atan2(face.normal.y(), face.normal.x());
  support.height = top.height;
  const Vector2d a = Eigen::Rotation2Dd(-support.yaw) * face.at(top.along_min);
  const Vector2d b = Eigen::Rotation2Dd(-support.yaw) * face.at(top.along_max);
  support.parts.push_back(
      {{a.x() - depth, std::min(a.y(), b.y())}, {a.x() + top.overhang, std::max(a.y(), b.y())}});
  return support;
}

/// Upward points and rays through the plane of a rectangle; sets its height to the peak of points near the
/// face's top.
PlaneEvidence evidence_of(const Surface& surface, Support& support) {
  const Extent& part = support.parts.front();
  const Eigen::Rotation2Dd axes_from_map(-support.yaw);
  std::vector<size_t> histogram(8, 0);
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    const double bin =
        (position.z() - support.height + kHiddenCounters.height_reach_m) / kHiddenCounters.height_bin_m;
    if (bin < 0 || bin >= static_cast<double>(histogram.size()) || !point.is_upward()) continue;
    if (part.contains(axes_from_map * position.head<2>())) ++histogram[static_cast<size_t>(bin)];
  }
  const auto peak = std::max_element(histogram.begin(), histogram.end()) - histogram.begin();
  support.height +=
      (static_cast<double>(peak) + 0.5) * kHiddenCounters.height_bin_m - kHiddenCounters.height_reach_m;
  PlaneEvidence evidence;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d end = point.position.cast<double>();
    const double above = end.z() - support.height;
    if (std::abs(above) < 0.02 && point.is_upward())
      evidence.support.push_back({end.head<2>(), point.position.z(), point.scan});
    if (above > 0.03 && above < 0.5) evidence.above.push_back(end.head<2>());
    if (!surface.free_space || above > -0.05) continue;
    const Vector3d origin = surface.origins[point.origin].cast<double>();
    const double start = origin.z() - support.height;
    if (start > 0)
      (above < -kRaster.sunk_m ? evidence.pierced : evidence.sunk)
          .push_back((origin + (end - origin) * (start / (start - above))).head<2>());
  }
  return evidence;
}

std::vector<Vector2d> corners(const Support& support) {
  const Extent& part = support.parts.front();
  const Eigen::Rotation2Dd turn = support.map_from_axes();
  return {turn * part.min, turn * Vector2d(part.max.x(), part.min.y()), turn * part.max,
          turn * Vector2d(part.min.x(), part.max.y())};
}

/// Whether supports that were seen directly cover most of the counter.
bool explained(const Support& counter, const std::vector<Support>& supports) {
  double sum = 0;
  for (const Support& support : supports)
    if (std::abs(support.height - counter.height) < kHiddenCounters.same_height_m)
      sum += covered_fraction(counter, support, kHiddenCounters.coverage_steps);
  return sum > 0.5;
}

/// Where two such counters meet in a corner of walls, neither face shows the corner: extends the larger one
/// to the other one's wall.
void fill_corners(std::vector<Support>& supports, const std::vector<VerticalPlane>& walls) {
  for (Support& counter : supports) {
    if (!counter.behind_face) continue;
    for (const Support& other : supports) {
      if (!other.behind_face || &other == &counter || other.wall == counter.wall ||
          other.area() > counter.area())
        continue;
      const VerticalPlane& wall = walls[static_cast<size_t>(other.wall)];
      for (const bool upper : {false, true}) {
        const Vector2d outward = counter.map_from_axes() * Vector2d(0, upper ? 1 : -1);
        if (wall.normal.dot(outward) > -0.9) continue;
        Extent& part = counter.parts.front();
        const Vector2d end(part.centre().x(), upper ? part.max.y() : part.min.y());
        const double distance = wall.normal.dot(counter.map_from_axes() * end) - wall.offset;
        Support grown = counter;
        (upper ? grown.parts.front().max.y() : grown.parts.front().min.y()) += upper ? distance : -distance;
        const Extent& box = grown.parts.front();
        const auto near = [&](const Vector2d& corner) {
          return box.contains(Eigen::Rotation2Dd(-counter.yaw) * corner, kHiddenCounters.corner_gap_m);
        };
        const std::vector<Vector2d> others = corners(other);
        if (distance < 0.3 || distance > kHiddenCounters.max_depth_m ||
            std::none_of(others.begin(), others.end(), near))
          continue;
        part = box;
        counter.edges[upper ? 3 : 2] = EdgeKind::wall;
      }
    }
  }
}

}  // namespace

void add_counters_behind_faces(std::vector<Support>& supports, const Surface& surface,
                               const std::vector<VerticalPlane>& faces,
                               const std::vector<VerticalPlane>& walls, double floor_height) {
  for (const VerticalPlane& face : faces) {
    if (face.length() < 0.5) continue;
    auto top = level_top(surface, face);
    if (!top || top->height < floor_height + 0.6 || top->height > floor_height + 1.15) continue;
    if (top->along_max - top->along_min < 0.5) continue;
    top->overhang = overhang(surface, face, *top);
    double depth = 0;
    const int wall = wall_behind(face, *top, walls, depth);
    if (wall < 0) continue;
    Support counter = between(face, *top, depth);
    const PlaneEvidence evidence = evidence_of(surface, counter);
    const PlaneRaster raster(evidence, corners(counter), counter.yaw, 0.02, 0.1);
    if (explained(counter, supports)) continue;
    const PlaneRaster::Counts counts = raster.count(counter.parts.front());
    const double cell_area = raster.cell() * raster.cell();

    if (counts.support * cell_area < kHiddenCounters.min_seen_m2 ||
        counts.pierced > kHiddenCounters.max_pierced * counts.cells)
      continue;
    const std::vector<Extent> parts = counter.parts;
    measure(counter, evidence, raster, {}, surface);
    counter.parts = parts;
    counter.edges = {EdgeKind::wall, EdgeKind::front, EdgeKind::unseen, EdgeKind::unseen};
    counter.wall = wall;
    counter.wall_distance = 0;
    counter.behind_face = true;
    std::erase_if(supports, [&](const Support& support) {
      return std::abs(support.height - counter.height) < kHiddenCounters.same_height_m &&
             covered_fraction(support, counter, kHiddenCounters.coverage_steps) > 0.5;
    });
    supports.push_back(std::move(counter));
  }
  fill_corners(supports, walls);
}

}  // namespace loci::mapping
