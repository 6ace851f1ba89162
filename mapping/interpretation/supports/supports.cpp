#include "mapping/interpretation/supports/supports.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/math.h"
#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/plane_raster.h"
#include "mapping/interpretation/supports/refinement.h"
#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {
namespace {

/// Upward points of one small column of space that lie at one height.
struct LayerCell {
  int x = 0, y = 0;  ///< column
  float height = 0;  ///< median
  int count = 0;
  int component = -1;

  Vector2d centre(double cell) const { return {(x + 0.5) * cell, (y + 0.5) * cell}; }
};

/// Connected pieces of upward surface.
struct Layers {
  double cell = 0.02;  ///< side of a column, metres
  std::vector<LayerCell> cells;
  std::vector<std::vector<uint32_t>> components;  ///< cells of each piece, largest piece first
};

struct ColumnPoint {
  uint32_t column;
  float z;
};

std::vector<LayerCell> cells_of(const Surface& surface, double lowest, double highest, double cell) {
  CellIndex columns(1U << 16U);
  std::vector<ColumnPoint> points;
  for (const SurfacePoint& point : surface.points) {
    const float z = point.position.z();
    if (!point.is_upward() || z < static_cast<float>(lowest) || z > static_cast<float>(highest)) continue;
    Eigen::Vector3i at = cell_of(point.position, cell);
    at.z() = 0;
    points.push_back({columns.insert(at), z});
  }
  std::stable_sort(points.begin(), points.end(), [](const ColumnPoint& a, const ColumnPoint& b) {
    return a.column != b.column ? a.column < b.column : a.z < b.z;
  });
  std::vector<LayerCell> cells;
  for (size_t begin = 0; begin < points.size();) {
    size_t end = begin + 1;
    while (end < points.size() && points[end].column == points[begin].column &&
           points[end].z - points[end - 1].z < kLayers.gap_m)
      ++end;
    const Eigen::Vector3i& at = columns.cells()[points[begin].column];
    if (end - begin >= kLayers.min_points)
      cells.push_back({at.x(), at.y(), points[(begin + end) / 2].z, static_cast<int>(end - begin), -1});
    begin = end;
  }
  return cells;
}

/// Upward points between two heights by column, grown into pieces of similar height.
Layers find_layers(const Surface& surface, double lowest, double highest) {
  Layers layers;
  layers.cells = cells_of(surface, lowest, highest, layers.cell);
  CellIndex columns(layers.cells.size());
  std::vector<std::vector<uint32_t>> in_column;
  for (uint32_t i = 0; i < layers.cells.size(); ++i) {
    const uint32_t column = columns.insert({layers.cells[i].x, layers.cells[i].y, 0});
    if (column == in_column.size()) in_column.emplace_back();
    in_column[column].push_back(i);
  }
  for (uint32_t seed = 0; seed < layers.cells.size(); ++seed) {
    if (layers.cells[seed].component >= 0) continue;
    const int number = static_cast<int>(layers.components.size());
    std::vector<uint32_t> piece = {seed};
    layers.cells[seed].component = number;
    for (size_t next = 0; next < piece.size(); ++next) {
      const LayerCell from = layers.cells[piece[next]];
      for (int dx = -kLayers.reach_columns; dx <= kLayers.reach_columns; ++dx)
        for (int dy = -kLayers.reach_columns; dy <= kLayers.reach_columns; ++dy) {
          const uint32_t column = columns.find({from.x + dx, from.y + dy, 0});
          if (column == CellIndex::kNone) continue;
          for (const uint32_t i : in_column[column]) {
            LayerCell& to = layers.cells[i];
            if (to.component >= 0 || std::abs(to.height - from.height) > kLayers.step_m) continue;
            to.component = number;
            piece.push_back(i);
          }
        }
    }
    layers.components.push_back(std::move(piece));
  }
  std::stable_sort(layers.components.begin(), layers.components.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (size_t number = 0; number < layers.components.size(); ++number)
    for (const uint32_t i : layers.components[number]) layers.cells[i].component = static_cast<int>(number);
  return layers;
}

/// z = height + slope · (x, y), the plane of a support; drift tilts it slightly.
struct HorizontalPlane {
  double height = 0;
  Vector2d slope = Vector2d::Zero();

  double above(const Vector3d& point) const { return point.z() - height - slope.dot(point.head<2>()); }
};

/// Robust fit with a prior for level planes, as errors are correlated over long stretches.
HorizontalPlane fit_plane(const Layers& layers, const std::vector<uint32_t>& cells) {
  std::vector<double> heights;
  for (const uint32_t i : cells) heights.push_back(static_cast<double>(layers.cells[i].height));
  HorizontalPlane plane{median(std::move(heights)), Vector2d::Zero()};
  for (int round = 0; round < 3; ++round) {
    std::vector<Vector3d> points;
    Vector3d mean = Vector3d::Zero();
    for (const uint32_t i : cells) {
      const LayerCell& cell = layers.cells[i];
      const Vector2d centre = cell.centre(layers.cell);
      const Vector3d point(centre.x(), centre.y(), static_cast<double>(cell.height));
      if (std::abs(plane.above(point)) > 0.025) continue;
      points.push_back(point);
      mean += point;
    }
    if (points.size() < 10) break;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix2d squares = kSupports.tilt_prior * Eigen::Matrix2d::Identity();
    Vector2d right = Vector2d::Zero();
    for (const Vector3d& point : points) {
      const Vector2d at = (point - mean).head<2>();
      squares += at * at.transpose();
      right += at * (point.z() - mean.z());
    }
    const Vector2d slope = squares.ldlt().solve(right);
    if (slope.norm() > kSupports.max_tilt) break;
    plane = {mean.z() - slope.dot(mean.head<2>()), slope};
  }
  return plane;
}

struct Seed {
  std::vector<Vector2d> points;
  HorizontalPlane plane;
};

/// A piece and all pieces of the same height that are near it, directly or through others.
Seed grow_seed(const Layers& layers, const std::vector<uint32_t>& cells, const std::vector<bool>& consumed) {
  Seed seed;
  seed.plane = fit_plane(layers, cells);
  Extent box = Extent::empty();
  const auto position = [&](uint32_t i) { return layers.cells[i].centre(layers.cell); };
  const auto add = [&](const std::vector<uint32_t>& piece) {
    for (const uint32_t i : piece) {
      seed.points.push_back(position(i));
      box.extend(seed.points.back());
    }
  };
  add(cells);
  std::set<int> used = {layers.cells[cells.front()].component};
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& piece : layers.components) {
      if (piece.size() < kSupports.min_piece_cells) break;
      const LayerCell& first = layers.cells[piece.front()];
      if (used.contains(first.component) || consumed[piece.front()]) continue;
      const auto near = [&](uint32_t i) { return box.contains(position(i), kSupports.reach_m); };
      const auto level = [&](uint32_t i) {
        const Vector2d at = position(i);
        return std::abs(seed.plane.above({at.x(), at.y(), static_cast<double>(layers.cells[i].height)})) <
               0.02;
      };
      if (std::none_of(piece.begin(), piece.end(), near)) continue;
      if (static_cast<size_t>(std::count_if(piece.begin(), piece.end(), level)) * 2 < piece.size()) continue;
      used.insert(first.component);
      grew = true;
      add(piece);
    }
  }
  return seed;
}

bool holds(const Support& support, const Vector3d& position) {
  return std::abs(position.z() - support.height) <= 0.05 && support.contains(position.head<2>(), 0.02);
}

/// Whether a support was already extended to this piece, behind an object.
bool is_part(const Support& piece, const std::vector<Support>& supports) {
  const Vector2d at = piece.map_from_axes() * piece.parts.front().centre();
  return std::any_of(supports.begin(), supports.end(), [&](const Support& support) {
    return holds(support, {at.x(), at.y(), piece.height});
  });
}

/// Where tall objects stand on a plane or cross it (a fridge beside a counter): what they hide is no support.
class TallObjects {
 public:
  void add(const Vector2d& position, double above) {
    if (above < 0 || above >= kSupports.tall_m) return;
    const uint32_t number =
        cells_.insert(cell_of(Vector3d(position.x(), position.y(), 0), kSupports.tall_cell_m));
    if (number == slices_.size()) slices_.push_back(0);
    slices_[number] |= 1U << static_cast<unsigned>(above / kSlice);
  }
  bool stands_at(const Vector2d& position) const {
    const uint32_t number =
        cells_.find(cell_of(Vector3d(position.x(), position.y(), 0), kSupports.tall_cell_m));
    return number != CellIndex::kNone && slices_[number] + 1 == 1U << kSupports.tall_slices;
  }

 private:
  static constexpr double kSlice = kSupports.tall_m / kSupports.tall_slices;
  CellIndex cells_;
  std::vector<unsigned> slices_;  ///< one bit for each slice of height in which something was seen
};

PlaneEvidence collect(const Surface& surface, const Seed& seed, const std::vector<Support>& found,
                      double tolerance) {
  PlaneEvidence evidence;
  Extent box = Extent::empty();
  for (const Vector2d& point : seed.points) box.extend(point);
  const auto add_ray = [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    const Vector3d origin = from.cast<double>();
    const Vector3d end = to.cast<double>();
    const double start_above = seed.plane.above(origin);
    const double end_above = seed.plane.above(end);
    if (start_above * end_above >= 0 || std::abs(end_above) < kSupports.through_m) return;
    const Vector2d crossing = (origin + (end - origin) * (start_above / (start_above - end_above))).head<2>();
    const bool deep = end_above < -kRaster.sunk_m || start_above < 0;
    if (box.contains(crossing, kSupports.lookout_m))
      (deep ? evidence.pierced : evidence.sunk).push_back(crossing);
  };
  TallObjects tall;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    if (box.contains(position.head<2>(), kSupports.lookout_m))
      tall.add(position.head<2>(), seed.plane.above(position));
  }
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    if (surface.free_space) add_ray(surface.origins[point.origin], point.position);
    if (!box.contains(position.head<2>(), kSupports.lookout_m)) continue;
    const double above = seed.plane.above(position);
    if (std::abs(above + kSupports.rim_depth_m / 2) < kSupports.rim_depth_m / 2 && !point.is_upward() &&
        !tall.stands_at(position.head<2>()))
      evidence.rim.push_back(position.head<2>());
    if (above < -1.3 * kSupports.rim_depth_m && above > -kSupports.below_m && !point.is_upward())
      evidence.below.push_back(position.head<2>());
    if (surface.free_space && above > 0.03 && !tall.stands_at(position.head<2>())) {
      const Vector3d origin = surface.origins[point.origin].cast<double>();
      const double start = seed.plane.above(origin);
      const double reach = start / (start - above);  // of the ray, in its lengths
      if (start > above && (reach - 1) * (position - origin).norm() < kSupports.max_shadow_m)
        evidence.shadow.push_back((origin + (position - origin) * reach).head<2>());
    }
    if (std::abs(above) < tolerance && point.is_upward()) {
      const bool taken =
          std::any_of(found.begin(), found.end(), [&](const Support& s) { return holds(s, position); });
      if (taken)
        evidence.taken.push_back(position.head<2>());
      else
        evidence.support.push_back({position.head<2>(), point.position.z(), point.scan});
    } else if (std::abs(above) < tolerance && point.may_be_upward()) {
      evidence.uncertain.push_back({position.head<2>(), point.position.z(), point.scan});
    } else if (above > 0.03 && above < 0.5)
      evidence.above.push_back(position.head<2>());
  }
  // Rays that did not return are no evidence here: a floor is below every support, so that something dark or
  // glossy swallowed them, and that may lie in the plane (the glass of a hob).
  return evidence;
}

bool touch(const Extent& a, const Extent& b) {
  const Vector2d low = a.min.cwiseMax(b.min);
  const Vector2d high = a.max.cwiseMin(b.max);
  const Vector2d overlap = high - low;
  return overlap.minCoeff() > -kSupports.touch_m && overlap.maxCoeff() > 0.25;
}

/// The rectangles of one plane, best first.
std::vector<Extent> rectangles(PlaneRaster& raster, const InterpretationOptions& options) {
  std::vector<Extent> found;
  for (int round = 0; round < kSupports.max_rectangles; ++round) {
    const Extent extent = raster.best_rectangle();
    const double cell_area = raster.cell() * raster.cell();
    if (extent.area() < options.min_support_area_m2) break;
    const PlaneRaster::Counts counts = raster.count(extent);
    raster.consume(extent);
    if (counts.support * cell_area < options.min_support_area_m2) continue;
    if (extent.size().minCoeff() < options.min_support_side_m) continue;
    if (counts.support < kSupports.min_fill * counts.cells) continue;
    found.push_back(extent);
  }
  return found;
}

/// Groups rectangles that touch into one support (a counter round a corner).
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

/// A part without what is farther than `line` along an axis (nearer, for the lower side): what it keeps.
Extent cut_at(Extent part, int axis, bool upper, double line) {
  (upper ? part.max : part.min)[axis] = line;
  return part;
}

/// The best rectangle of a slab with wings takes in what lies between them, as their surface outweighs it.
/// Draws each side back as far as what leaves the union, with the wings continued to the new side, is
/// evidence against it.
void tighten(std::vector<Extent>& parts, const PlaneRaster& raster) {
  for (size_t i = 0; i < parts.size(); ++i)
    for (const int axis : {0, 1})
      for (const bool upper : {false, true}) {
        const Extent part = parts[i];
        const double side = upper ? part.max[axis] : part.min[axis];
        const double inward = upper ? -1 : 1;
        std::vector<Extent> best = parts;
        double least = 0;
        for (double by = raster.cell(); by < part.size()[axis] - kSupports.touch_m; by += raster.cell()) {
          const double line = side + inward * by;
          std::vector<Extent> drawn = parts;
          drawn[i] = cut_at(part, axis, upper, line);
          double lost = 0;
          for (size_t k = 0; k < parts.size(); ++k) {
            const double near = upper ? parts[k].min[axis] : parts[k].max[axis];
            if (k == i || !touch(parts[k], part) || inward * (line - near) < 0) continue;
            drawn[k] = cut_at(parts[k], axis, !upper, line);
            lost -= raster.score_outside(cut_at(drawn[k], axis, upper, near), parts);
          }
          lost += raster.score_outside(cut_at(part, axis, !upper, line), drawn);
          if (lost < least) least = lost, best = drawn;
        }
        parts = std::move(best);
      }
}

/// Whether two rectangles touch and agree in front and back.
bool in_one_row(const Extent& a, const Extent& b) {
  return touch(a, b) && std::ranges::any_of(std::array{0, 1}, [&](int axis) {
           return std::abs(a.min[axis] - b.min[axis]) < kSupports.row_m &&
                  std::abs(a.max[axis] - b.max[axis]) < kSupports.row_m;
         });
}

void unite_rows(std::vector<Extent>& parts) {
  for (size_t i = 0; i < parts.size(); ++i)
    for (size_t j = i + 1; j < parts.size(); ++j) {
      if (!in_one_row(parts[i], parts[j])) continue;
      parts[i].extend(parts[j]);
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(j));
      j = i;  // Check the others again.
    }
}

/// Whether two supports are pieces of one slab: they touch after they were extended behind the object that
/// separates them.
bool one_slab(const Support& a, const Support& b) {
  if (!a.polygon.empty() || !b.polygon.empty() || std::abs(a.height - b.height) > kSupports.same_level_m ||
      std::abs(a.yaw - b.yaw) > kSupports.same_yaw)
    return false;
  return std::ranges::any_of(a.parts, [&](const Extent& part) {
    return std::ranges::any_of(b.parts, [&](const Extent& other) { return in_one_row(part, other); });
  });
}

/// Joins two pieces of a slab; the edges are those of the larger one.
void join(Support& piece, const Support& other) {
  Support both = piece.area() < other.area() ? other : piece;
  const Support& smaller = piece.area() < other.area() ? piece : other;
  both.parts.insert(both.parts.end(), smaller.parts.begin(), smaller.parts.end());
  unite_rows(both.parts);
  const double share = smaller.observed_area / (smaller.observed_area + both.observed_area);
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

bool Support::contains(const Vector2d& map_point, double margin) const {
  const Vector2d at = Eigen::Rotation2Dd(-yaw) * map_point;
  return std::ranges::any_of(parts, [&](const Extent& part) { return part.contains(at, margin); });
}

double covered_fraction(const Support& inner, const Support& outer, int steps, double margin) {
  const Extent& part = inner.parts.front();
  int inside = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const Vector2d local =
          part.min + Vector2d((i + 0.5) / steps, (j + 0.5) / steps).cwiseProduct(part.size());
      inside += outer.contains(inner.map_from_axes() * local, margin);
    }
  return static_cast<double>(inside) / (steps * steps);
}

SupportSearch find_supports(const Surface& surface, double floor_height, double yaw,
                            const WallSearch& vertical, const InterpretationOptions& options,
                            Progress& progress) {
  SupportSearch result;
  const Layers layers = find_layers(surface, floor_height + kSupports.min_height_m,
                                    floor_height + options.max_support_height_m);
  std::vector<bool> consumed(layers.cells.size(), false);
  const auto consume = [&](const Support& support) {
    for (size_t i = 0; i < layers.cells.size(); ++i) {
      const LayerCell& cell = layers.cells[i];
      if (std::abs(static_cast<double>(cell.height) - support.height) > 0.03) continue;
      if (support.contains(cell.centre(layers.cell), 0.03)) consumed[i] = true;
    }
  };
  const double cell_area = layers.cell * layers.cell;
  for (size_t number = 0; number < layers.components.size(); ++number) {
    progress.check(static_cast<double>(number) / static_cast<double>(layers.components.size()), "supports");
    std::vector<uint32_t> cells;
    for (const uint32_t i : layers.components[number])
      if (!consumed[i]) cells.push_back(i);
    if (static_cast<double>(layers.components[number].size()) * cell_area < options.min_support_area_m2 / 2)
      break;
    if (static_cast<double>(cells.size()) * cell_area < options.min_support_area_m2 / 2) continue;
    const Seed seed = grow_seed(layers, cells, consumed);
    const PlaneEvidence evidence = collect(surface, seed, result.supports, options.plane_tolerance_m);
    const double own_yaw = support_yaw(evidence, seed.points, yaw);
    PlaneRaster raster(evidence, seed.points, own_yaw, kSupports.cell_m, kSupports.margin_m);
    const PlaneRaster whole = raster;
    for (std::vector<Extent>& parts : grouped(rectangles(raster, options))) {
      if (parts.size() > 1) tighten(parts, whole);
      Support support;
      support.yaw = own_yaw;
      support.parts = std::move(parts);
      support.height =
          seed.plane.height + seed.plane.slope.dot(support.map_from_axes() * support.parts.front().centre());
      if (is_part(support, result.supports)) continue;
      extend_behind_objects(support, evidence, vertical.others);
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
