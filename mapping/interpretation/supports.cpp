#include "mapping/interpretation/supports.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/cell_index.h"
#include "mapping/base/math.h"
#include "mapping/base/quantile.h"
#include "mapping/interpretation/layers.h"
#include "mapping/interpretation/plane_raster.h"
#include "mapping/interpretation/support_checks.h"

namespace loci::mapping {
namespace {

constexpr double kLowest = 0.2;       // m above the floor
constexpr double kRasterCell = 0.02;  // m
constexpr double kCoarseCell = 0.04;  // m, for the search of the yaw
constexpr double kReach = 0.4;        // m; pieces of one height this near are looked at together
constexpr double kLookout = 0.9;    // m; what is known so near is looked at: a slab may go on behind a thing
constexpr double kMargin = 0.1;     // m around the pieces
constexpr double kThrough = 0.05;   // m; a ray that comes from above and ends this far below passed through
constexpr double kRimDepth = 0.03;  // m below a plane that belong to the edge of its slab
constexpr double kBelow = 0.15;  // m below a plane, to which its slab's edge is compared with what carries it
constexpr double kLongestShadow = 1.0;  // m from a thing on a plane to what it hides of it
constexpr double kMaxTilt = 0.03;       // slope; more is no support, drift makes less
constexpr double kTouch = 0.06;         // m between rectangles of one support

/// z = height + slope · (x, y) - what a support's points lie on; drift tilts it a little.
struct HorizontalPlane {
  double height = 0;
  Vector2d slope = Vector2d::Zero();

  double above(const Vector3d& point) const { return point.z() - height - slope.dot(point.head<2>()); }
};

/// Robust fit; the slope is held back where little surface speaks for it, since noise is alike over long
/// stretches.
HorizontalPlane fit_plane(const Layers& layers, const std::vector<uint32_t>& cells) {
  constexpr double kHoldBack = 60;  // as so many cells 1 m away that say "level"
  std::vector<double> heights;
  for (const uint32_t i : cells) heights.push_back(static_cast<double>(layers.cells[i].height));
  HorizontalPlane plane{median(std::move(heights)), Vector2d::Zero()};
  for (int round = 0; round < 3; ++round) {
    std::vector<Vector3d> points;
    Vector3d mean = Vector3d::Zero();
    for (const uint32_t i : cells) {
      const LayerCell& cell = layers.cells[i];
      const Vector3d point((cell.x + 0.5) * layers.cell, (cell.y + 0.5) * layers.cell,
                           static_cast<double>(cell.height));
      if (std::abs(plane.above(point)) > 0.025) continue;
      points.push_back(point);
      mean += point;
    }
    if (points.size() < 10) break;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix2d squares = kHoldBack * Eigen::Matrix2d::Identity();
    Vector2d right = Vector2d::Zero();
    for (const Vector3d& point : points) {
      const Vector2d at = (point - mean).head<2>();
      squares += at * at.transpose();
      right += at * (point.z() - mean.z());
    }
    const Vector2d slope = squares.ldlt().solve(right);
    if (slope.norm() > kMaxTilt) break;
    plane = {mean.z() - slope.dot(mean.head<2>()), slope};
  }
  return plane;
}

struct Seed {
  std::vector<Vector2d> points;
  HorizontalPlane plane;
};

/// The piece and all pieces of the same height near it, as far as they chain.
Seed grow_seed(const Layers& layers, const std::vector<uint32_t>& cells, const std::vector<bool>& consumed) {
  Seed seed;
  seed.plane = fit_plane(layers, cells);
  Extent box{Vector2d::Constant(1e9), Vector2d::Constant(-1e9)};
  const auto position = [&](const LayerCell& cell) {
    return Vector2d((cell.x + 0.5) * layers.cell, (cell.y + 0.5) * layers.cell);
  };
  for (const uint32_t i : cells) {
    seed.points.push_back(position(layers.cells[i]));
    box = {box.min.cwiseMin(seed.points.back()), box.max.cwiseMax(seed.points.back())};
  }
  std::set<int> used = {layers.cells[cells.front()].component};
  constexpr size_t kMin = 6;
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& piece : layers.components) {
      if (piece.size() < kMin) break;
      const LayerCell& first = layers.cells[piece.front()];
      if (used.contains(first.component) || consumed[piece.front()]) continue;
      const auto near = [&](uint32_t i) { return box.contains(position(layers.cells[i]), kReach); };
      const auto level = [&](uint32_t i) {
        const Vector2d at = position(layers.cells[i]);
        return std::abs(seed.plane.above({at.x(), at.y(), static_cast<double>(layers.cells[i].height)})) <
               0.02;
      };
      if (std::none_of(piece.begin(), piece.end(), near)) continue;
      if (static_cast<size_t>(std::count_if(piece.begin(), piece.end(), level)) * 2 < piece.size()) continue;
      used.insert(first.component);
      grew = true;
      for (const uint32_t i : piece) {
        seed.points.push_back(position(layers.cells[i]));
        box = {box.min.cwiseMin(seed.points.back()), box.max.cwiseMax(seed.points.back())};
      }
    }
  }
  return seed;
}

bool holds(const Support& support, const Vector3d& position) {
  if (std::abs(position.z() - support.height) > 0.05) return false;
  const Vector2d at = Eigen::Rotation2Dd(-support.yaw) * position.head<2>();
  return std::any_of(support.parts.begin(), support.parts.end(),
                     [&](const Extent& part) { return part.contains(at, 0.02); });
}

/// Whether a support has gone on to here, behind what stands on it.
bool is_part(const Support& piece, const std::vector<Support>& supports) {
  const Vector2d at = piece.map_from_axes() * piece.parts.front().centre();
  return std::any_of(supports.begin(), supports.end(), [&](const Support& support) {
    return holds(support, {at.x(), at.y(), piece.height});
  });
}

/// Where tall things stand on a plane or go through it (a fridge beside a counter): what they hide is not
/// their support.
class TallThings {
 public:
  void add(const Vector2d& position, double above) {
    if (above < 0 || above >= kTall) return;
    const uint32_t number = cells_.insert(cell_of(Vector3d(position.x(), position.y(), 0), kCell));
    if (number == slices_.size()) slices_.push_back(0);
    slices_[number] |= 1U << static_cast<unsigned>(above / kSlice);
  }
  bool stands_at(const Vector2d& position) const {
    const uint32_t number = cells_.find(cell_of(Vector3d(position.x(), position.y(), 0), kCell));
    return number != CellIndex::kNone && slices_[number] + 1 == 1U << kSlices;
  }

 private:
  static constexpr double kTall = 0.6;  // m; things that stand on a counter are lower
  static constexpr double kCell = 0.05;
  static constexpr unsigned kSlices = 5;
  static constexpr double kSlice = kTall / kSlices;
  CellIndex cells_;
  std::vector<unsigned> slices_;  ///< one bit for each slice of height in which something was seen
};

PlaneEvidence collect(const Surface& surface, const Seed& seed, const std::vector<Support>& found,
                      double tolerance) {
  PlaneEvidence evidence;
  Extent box{Vector2d::Constant(1e9), Vector2d::Constant(-1e9)};
  for (const Vector2d& point : seed.points) box = {box.min.cwiseMin(point), box.max.cwiseMax(point)};
  const auto add_ray = [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    const Vector3d origin = from.cast<double>();
    const Vector3d end = to.cast<double>();
    const double start_above = seed.plane.above(origin);
    const double end_above = seed.plane.above(end);
    if (start_above * end_above >= 0 || std::abs(end_above) < kThrough) return;
    const Vector2d crossing = (origin + (end - origin) * (start_above / (start_above - end_above))).head<2>();
    const bool deep = end_above < -kSunk || start_above < 0;
    if (box.contains(crossing, kLookout)) (deep ? evidence.pierced : evidence.sunk).push_back(crossing);
  };
  TallThings tall;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    if (box.contains(position.head<2>(), kLookout)) tall.add(position.head<2>(), seed.plane.above(position));
  }
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    if (surface.free_space) add_ray(surface.origins[point.origin], point.position);
    if (!box.contains(position.head<2>(), kLookout)) continue;
    const double above = seed.plane.above(position);
    if (std::abs(above + kRimDepth / 2) < kRimDepth / 2 && !looks_up(point) &&
        !tall.stands_at(position.head<2>()))
      evidence.rim.push_back(position.head<2>());
    if (above < -1.3 * kRimDepth && above > -kBelow && !looks_up(point))
      evidence.below.push_back(position.head<2>());
    if (surface.free_space && above > 0.03 && !tall.stands_at(position.head<2>())) {
      const Vector3d origin = surface.origins[point.origin].cast<double>();
      const double start = seed.plane.above(origin);
      const double reach = start / (start - above);  // of the ray, in its lengths
      if (start > above && (reach - 1) * (position - origin).norm() < kLongestShadow)
        evidence.shadow.push_back((origin + (position - origin) * reach).head<2>());
    }
    if (std::abs(above) < tolerance && looks_up(point)) {
      const bool taken =
          std::any_of(found.begin(), found.end(), [&](const Support& s) { return holds(s, position); });
      if (taken)
        evidence.taken.push_back(position.head<2>());
      else
        evidence.support.push_back({position.head<2>(), point.position.z(), point.scan});
    } else if (std::abs(above) < tolerance && may_look_up(point)) {
      evidence.brink.push_back({position.head<2>(), point.position.z(), point.scan});
    } else if (above > 0.03 && above < 0.5)
      evidence.above.push_back(position.head<2>());
  }
  if (surface.free_space)
    for (const auto& [end, origin] : surface.free_ends) add_ray(surface.origins[origin], end);
  return evidence;
}

/// The yaw of the smallest rectangle around the surface.
double box_yaw(const PlaneEvidence& evidence) {
  std::vector<cv::Point2f> points;
  for (const auto& point : evidence.support)
    points.emplace_back(static_cast<float>(point.position.x()), static_cast<float>(point.position.y()));
  if (points.size() < 3) return 0;
  return cv::minAreaRect(points).angle * kPi / 180;
}

/// The yaw in which one rectangle explains most: the room's, one near it, or an askew table's own; the room's
/// unless another is clearly better and there is surface enough to tell.
double local_yaw(const PlaneEvidence& evidence, const Seed& seed, double room_yaw) {
  constexpr double kQuarter = kPi / 2;
  constexpr double kEnough = 0.3;  // m²
  constexpr double kClearly = 1.05;
  const auto score_at = [&](double yaw) {
    double score = 0;
    PlaneRaster(evidence, seed.points, yaw, kCoarseCell, kMargin).best_rectangle(&score);
    return score;
  };
  double best_yaw = room_yaw;
  const double at_room_yaw = score_at(room_yaw);
  if (at_room_yaw < kEnough) return room_yaw;
  double best = kClearly * at_room_yaw;
  const auto try_yaw = [&](double yaw) {
    const double score = score_at(yaw);
    if (score <= best) return;
    best = score;
    best_yaw = yaw;
  };
  for (int step = -10; step <= 10; ++step) try_yaw(room_yaw + step * kDegree);
  if (best_yaw == room_yaw) try_yaw(room_yaw + std::remainder(box_yaw(evidence) - room_yaw, kQuarter));
  if (best_yaw == room_yaw) return room_yaw;
  const double around = best_yaw;
  for (int step = -5; step <= 5; ++step) try_yaw(around + 0.4 * step * kDegree);
  return best_yaw;
}

bool touch(const Extent& a, const Extent& b) {
  const Vector2d low = a.min.cwiseMax(b.min);
  const Vector2d high = a.max.cwiseMin(b.max);
  const Vector2d overlap = high - low;
  return overlap.minCoeff() > -kTouch && overlap.maxCoeff() > 0.25;
}

/// The rectangles of one plane, best first.
std::vector<Extent> rectangles(PlaneRaster& raster, const InterpretationOptions& options) {
  std::vector<Extent> found;
  constexpr int kMax = 8;
  constexpr double kMinFill = 0.3;
  for (int round = 0; round < kMax; ++round) {
    const Extent extent = raster.best_rectangle();
    const double cell_area = raster.cell() * raster.cell();
    if (extent.area() < options.support_min_area_m2) break;
    const PlaneRaster::Counts counts = raster.count(extent);
    raster.consume(extent);
    if (counts.support * cell_area < options.support_min_area_m2) continue;
    if (extent.size().minCoeff() < options.support_min_side_m) continue;
    if (counts.support < kMinFill * counts.cells) continue;
    found.push_back(extent);
  }
  return found;
}

/// Rectangles that touch become one support (a counter round a corner).
std::vector<std::vector<Extent>> grouped(const std::vector<Extent>& rectangles) {
  std::vector<std::vector<Extent>> groups;
  for (const Extent& extent : rectangles) {
    const auto near = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return std::any_of(group.begin(), group.end(),
                         [&](const Extent& other) { return touch(extent, other); });
    });
    if (near == groups.end())
      groups.push_back({extent});
    else
      near->push_back(extent);
  }
  return groups;
}

/// Whether two rectangles touch and lie in one row: as deep, and level with each other at front and back.
bool in_one_row(const Extent& a, const Extent& b) {
  constexpr double kAlike = 0.04;  // m
  return touch(a, b) && std::ranges::any_of(std::array{0, 1}, [&](int axis) {
           return std::abs(a.min[axis] - b.min[axis]) < kAlike &&
                  std::abs(a.max[axis] - b.max[axis]) < kAlike;
         });
}

void unite_rows(std::vector<Extent>& parts) {
  for (size_t i = 0; i < parts.size(); ++i)
    for (size_t j = i + 1; j < parts.size(); ++j) {
      if (!in_one_row(parts[i], parts[j])) continue;
      parts[i] = {parts[i].min.cwiseMin(parts[j].min), parts[i].max.cwiseMax(parts[j].max)};
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(j));
      j = i;  // The others anew.
    }
}

/// Two pieces of one slab, found one after the other because of what stands between: after they were extended
/// behind it, they touch.
bool one_slab(const Support& a, const Support& b) {
  constexpr double kLevel = 0.01;   // m
  constexpr double kTurned = 0.01;  // rad
  if (!a.polygon.empty() || !b.polygon.empty() || std::abs(a.height - b.height) > kLevel ||
      std::abs(a.yaw - b.yaw) > kTurned)
    return false;
  return std::ranges::any_of(a.parts, [&](const Extent& part) {
    return std::ranges::any_of(b.parts, [&](const Extent& other) { return in_one_row(part, other); });
  });
}

/// Makes one support of two pieces of a slab; the larger one says what its edges are.
void join(Support& piece, const Support& other) {
  Support both = piece.area() < other.area() ? other : piece;
  const Support& smaller = piece.area() < other.area() ? piece : other;
  both.parts.insert(both.parts.end(), smaller.parts.begin(), smaller.parts.end());
  unite_rows(both.parts);
  const auto areas = [](const Support& support) { return support.observed_area; };
  const double share = areas(smaller) / (areas(smaller) + areas(both));
  both.seen_below += share * (smaller.seen_below - both.seen_below);
  both.sd = std::max(both.sd, smaller.sd);
  both.observed_area += smaller.observed_area;
  both.pierced_area += smaller.pierced_area;
  both.inliers += smaller.inliers;
  both.scans.insert(both.scans.end(), smaller.scans.begin(), smaller.scans.end());
  std::ranges::sort(both.scans);
  both.scans.erase(std::unique(both.scans.begin(), both.scans.end()), both.scans.end());
  piece = std::move(both);
}

}  // namespace

const char* edge_kind_name(EdgeKind kind) {
  return kind == EdgeKind::free    ? "free"
         : kind == EdgeKind::wall  ? "wall"
         : kind == EdgeKind::front ? "front"
                                   : "unseen";
}

double Support::area() const {
  double sum = 0;
  if (!polygon.empty()) {
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d& a = polygon[i];
      const Vector2d& b = polygon[(i + 1) % polygon.size()];
      sum += (a.x() * b.y() - b.x() * a.y()) / 2;
    }
    return sum;
  }
  for (const Extent& part : parts) sum += part.area();
  return sum;
}

SupportSearch find_supports(const Surface& surface, double floor_height, double yaw,
                            const WallSearch& vertical, const InterpretationOptions& options,
                            Progress& progress) {
  SupportSearch result;
  const Layers layers =
      find_layers(surface, floor_height + kLowest, floor_height + options.support_max_height_m);
  std::vector<bool> consumed(layers.cells.size(), false);
  const auto consume = [&](const Support& support) {
    for (size_t i = 0; i < layers.cells.size(); ++i) {
      const LayerCell& cell = layers.cells[i];
      if (std::abs(static_cast<double>(cell.height) - support.height) > 0.03) continue;
      const Vector2d at = Eigen::Rotation2Dd(-support.yaw) *
                          Vector2d((cell.x + 0.5) * layers.cell, (cell.y + 0.5) * layers.cell);
      for (const Extent& part : support.parts)
        if (part.contains(at, 0.03)) consumed[i] = true;
    }
  };
  const double cell_area = layers.cell * layers.cell;
  for (size_t number = 0; number < layers.components.size(); ++number) {
    progress.check(static_cast<double>(number) / static_cast<double>(layers.components.size()), "supports");
    std::vector<uint32_t> cells;
    for (const uint32_t i : layers.components[number])
      if (!consumed[i]) cells.push_back(i);
    if (static_cast<double>(layers.components[number].size()) * cell_area < options.support_min_area_m2 / 2)
      break;
    if (static_cast<double>(cells.size()) * cell_area < options.support_min_area_m2 / 2) continue;
    const Seed seed = grow_seed(layers, cells, consumed);
    const PlaneEvidence evidence = collect(surface, seed, result.supports, options.plane_tolerance_m);
    const double support_yaw = local_yaw(evidence, seed, yaw);
    PlaneRaster raster(evidence, seed.points, support_yaw, kRasterCell, kMargin);
    const PlaneRaster whole = raster;
    for (std::vector<Extent>& parts : grouped(rectangles(raster, options))) {
      Support support;
      support.yaw = support_yaw;
      support.parts = std::move(parts);
      support.height =
          seed.plane.height + seed.plane.slope.dot(support.map_from_axes() * support.parts.front().centre());
      if (is_part(support, result.supports)) continue;
      extend_behind_things(support, evidence, vertical.others);
      measure(support, evidence, whole, vertical.walls, surface);
      fit_outline(support, evidence, whole);
      consume(support);
      const auto piece = std::ranges::find_if(result.supports,
                                              [&](const Support& other) { return one_slab(other, support); });
      if (piece != result.supports.end())
        join(*piece, support);
      else
        result.supports.push_back(std::move(support));
    }
  }
  add_counters_behind_faces(result.supports, surface, vertical.others, vertical.walls, floor_height);
  classify(result, surface, floor_height);
  return result;
}

}  // namespace loci::mapping
