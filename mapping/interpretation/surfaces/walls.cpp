#include "mapping/interpretation/surfaces/walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/moments.h"
#include "mapping/base/parallel.h"
#include "mapping/interpretation/surfaces/parameters.h"
#include "mapping/interpretation/surfaces/plane_cells.h"
#include "mapping/interpretation/surfaces/surface.h"
#include "mapping/interpretation/surfaces/vertical_planes.h"

namespace loci::mapping {
namespace {

/// Same result on any number of threads.
std::vector<RayEvidence> ray_evidence(const Surface& surface, const std::vector<VerticalPlane>& planes,
                                      int threads) {
  std::vector<RayEvidence> result(planes.size());
  const size_t step = (surface.points.size() + surface.free_ends.size()) / kWalls.max_rays + 1;
  parallel_for(planes.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      PlaneCells cells(planes[i], kWalls.ray_cell_m, kWalls.on_plane_m, kWalls.crossed_m);
      cells.add(surface, step);
      result[i] = cells.evidence();
    }
  });
  return result;
}

/// Fits a plane to all its points but those near its ends, where surfels mix in the adjoining planes.
void refine_wall(VerticalPlane& plane, const Surface& surface) {
  for (const double tolerance : {0.03, 0.025, 0.02}) {
    const double inset = std::min(kWalls.end_inset_m, plane.length() / 4);
    const Vector2d centre = plane.at((plane.along_min + plane.along_max) / 2);
    Moments<2> inliers;
    for (const SurfacePoint& point : surface.points) {
      const Vector2d at = point.position.head<2>().cast<double>();
      if (std::abs(plane.normal.dot(at) - plane.offset) > tolerance) continue;
      if (point.normal.head<2>().dot(plane.normal.cast<float>()) < kWalls.refine_cosine) continue;
      const double along = plane.direction().dot(at);
      const double z = static_cast<double>(point.position.z());
      if (along < plane.along_min + inset || along > plane.along_max - inset) continue;
      if (z < plane.bottom + inset || z > plane.top - inset) continue;
      inliers.add(at - centre);
    }
    if (inliers.count < kWalls.min_refine_points) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(inliers.covariance());
    Vector2d normal = solver.eigenvectors().col(0);
    if (normal.dot(plane.normal) < 0) normal = -normal;
    if (normal.dot(plane.normal) < 0.999) return;
    const Vector2d start = plane.at(plane.along_min);
    const Vector2d end = plane.at(plane.along_max);
    plane.normal = normal;
    plane.offset = normal.dot(centre + inliers.mean());
    plane.along_min = plane.direction().dot(start);
    plane.along_max = plane.direction().dot(end);
  }
}

/// Whether small objects protrude from a plane, as handles and knobs do: where one is, much of what was seen
/// is before the plane. A few measurements of a large plane are anywhere.
bool has_fixtures(const Surface& surface, const VerticalPlane& plane) {
  struct Seen {
    size_t before = 0, on_plane = 0;
  };
  std::map<std::pair<int, int>, Seen> cells;  // along the plane, and up
  const auto cell_of = [](double metres) { return static_cast<int>(std::floor(metres / kWalls.column_m)); };
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    const double before = plane.normal.dot(position.head<2>()) - plane.offset;
    if (before < -kWalls.min_fixture_m || before > kWalls.max_fixture_m) continue;
    const double along = plane.direction().dot(position.head<2>());
    if (along < plane.along_min + kWalls.fixture_inset_m || along > plane.along_max - kWalls.fixture_inset_m)
      continue;
    if (position.z() < plane.bottom + kWalls.fixture_inset_m ||
        position.z() > std::min(plane.top - kWalls.fixture_inset_m, kWalls.max_reach_m))
      continue;
    Seen& seen = cells[{cell_of(along), cell_of(position.z())}];
    ++(before < kWalls.min_fixture_m ? seen.on_plane : seen.before);
  }
  size_t count = 0;
  for (const auto& [cell, seen] : cells)
    if (static_cast<double>(seen.before) >
        kWalls.min_fixture_share * static_cast<double>(seen.before + seen.on_plane))
      count += seen.before;
  return count >= kWalls.min_fixture_points;
}

struct WallCandidate {
  PlanePatch patch;
  RayEvidence rays;
};

/// Overlap of two planes along the first one, metres; negative = the gap between them.
double shared_length(const VerticalPlane& a, const VerticalPlane& b) {
  const double first = a.direction().dot(b.at(b.along_min));
  const double second = a.direction().dot(b.at(b.along_max));
  return std::min(a.along_max, std::max(first, second)) - std::max(a.along_min, std::min(first, second));
}

Vector2d middle_of(const VerticalPlane& plane) {
  return plane.at((plane.along_min + plane.along_max) / 2);
}

std::string described(const VerticalPlane& plane) {
  const Vector2d middle = middle_of(plane);
  return fmt::format("vertical plane of {:.2f} m2 at ({:.2f}, {:.2f}) is no wall: ", plane.area, middle.x(),
                     middle.y());
}

/// Fraction of the plane's length, in columns, behind which something was seen.
double seen_behind(const std::vector<Surfel>& surfels, const VerticalPlane& plane, double floor_height) {
  const double margin = std::min(0.1, plane.length() / 4);
  const auto columns = static_cast<size_t>((plane.length() - 2 * margin) / kWalls.column_m) + 1;
  std::vector<int> behind(columns, 0);
  for (const Surfel& surfel : surfels) {
    if (surfel.position.z() < floor_height + 0.1) continue;
    const double depth = plane.offset - plane.normal.dot(surfel.position.head<2>());
    if (depth < kWalls.behind_m || depth > 4) continue;
    const double along = plane.direction().dot(surfel.position.head<2>()) - plane.along_min - margin;
    if (along < 0 || along >= static_cast<double>(columns) * kWalls.column_m) continue;
    ++behind[static_cast<size_t>(along / kWalls.column_m)];
  }
  const auto seen = std::count_if(behind.begin(), behind.end(), [](int count) { return count >= 3; });
  return static_cast<double>(seen) / static_cast<double>(columns);
}

/// Why a plane does not reach from floor to ceiling as walls do; empty when it does.
std::string why_not_full_height(const WallCandidate& candidate, double floor_height,
                                std::optional<double> ceiling, bool free_space,
                                const InterpretationOptions& options) {
  const VerticalPlane& plane = candidate.patch.plane;
  if (plane.top < floor_height + options.min_wall_top_m)
    return fmt::format("its top is at {:.2f} m", plane.top);
  if (free_space && candidate.rays.passed_over > kWalls.max_passed_over)
    return fmt::format("something was seen over {:.0f} % of its length", 100 * candidate.rays.passed_over);
  if (free_space && candidate.rays.pierced > kWalls.max_pierced)
    return fmt::format("rays passed through {:.0f} % of it", 100 * candidate.rays.pierced);
  if (ceiling && plane.top < *ceiling - kWalls.below_ceiling_m && plane.length() < kWalls.cupboard_side_m)
    return fmt::format("it is {:.2f} m wide and ends {:.2f} m below the ceiling", plane.length(),
                       *ceiling - plane.top);
  const bool full_height = (ceiling && plane.top > *ceiling - kWalls.at_ceiling_m) ||
                           (free_space && candidate.rays.seen_above > kWalls.min_seen_above);
  if (!full_height && plane.behind > kWalls.max_behind)
    return fmt::format("something was seen behind {:.0f} % of its length", 100 * plane.behind);
  return {};
}

/// Whether b continues a in the same plane, with at most a door between them, or a window (a pane or niche
/// a little behind).
bool continues(const VerticalPlane& a, const VerticalPlane& b, const std::vector<WallCandidate>& all) {
  if (a.normal.dot(b.normal) < kWalls.parallel_cosine) return false;
  const double between = std::max(std::abs(a.normal.dot(middle_of(b)) - a.offset),
                                  std::abs(b.normal.dot(middle_of(a)) - b.offset));
  const double gap = -shared_length(a, b);
  if (gap < -0.1 || between > kWalls.same_plane_m + 0.01 * std::max(0.0, gap)) return false;
  if (gap < kWalls.max_door_m) return true;
  VerticalPlane opening = a;
  const double start = a.direction().dot(middle_of(b)) > a.along_max ? a.along_max : a.along_min - gap;
  opening.along_min = start;
  opening.along_max = start + gap;
  return std::any_of(all.begin(), all.end(), [&](const WallCandidate& other) {
    const VerticalPlane& pane = other.patch.plane;
    const double depth = opening.offset - opening.normal.dot(middle_of(pane));
    return pane.normal.dot(a.normal) > kWalls.parallel_cosine && depth > kWalls.min_window_depth_m &&
           depth < kWalls.max_window_depth_m && shared_length(opening, pane) > 0.5 * gap;
  });
}

void unite_pieces(std::vector<WallCandidate>& walls, const std::vector<Surfel>& surfels,
                  const std::vector<WallCandidate>& all) {
  for (bool again = true; again;) {
    again = false;
    for (size_t i = 0; i < walls.size() && !again; ++i)
      for (size_t j = i + 1; j < walls.size() && !again; ++j) {
        if (!continues(walls[i].patch.plane, walls[j].patch.plane, all)) continue;
        const double behind = std::max(walls[i].patch.plane.behind, walls[j].patch.plane.behind);
        walls[i].patch = united(surfels, walls[i].patch, walls[j].patch);
        walls[i].patch.plane.behind = behind;
        walls.erase(walls.begin() + static_cast<std::ptrdiff_t>(j));
        again = true;
      }
  }
}

/// Whether a plane is a window pane of a wall: a little behind it and less high.
bool is_window_pane(const VerticalPlane& pane, const VerticalPlane& wall, double floor_height) {
  if (pane.normal.dot(wall.normal) < kWalls.parallel_cosine) return false;
  const double depth = wall.offset - wall.normal.dot(middle_of(pane));
  if (depth < kWalls.min_window_depth_m || depth > kWalls.max_window_depth_m) return false;
  const bool lower = pane.top < wall.top - 0.1 || pane.bottom > floor_height + 0.3;
  return lower && shared_length(wall, pane) > 0.9 * pane.length();
}

/// The distance, within the depth of furniture, from a plane to a parallel wall that continues beside it; 0
/// for none. Such a plane is the front of tall furniture; where it reaches the ceiling, only if it has
/// fixtures.
double depth_before_wall(const VerticalPlane& plane, const std::vector<WallCandidate>& walls) {
  double before = 0;
  for (const WallCandidate& other : walls) {
    const VerticalPlane& wall = other.patch.plane;
    const double distance = wall.normal.dot(middle_of(plane)) - wall.offset;
    if (wall.normal.dot(plane.normal) < 0.99 || distance < kWalls.min_furniture_depth_m ||
        distance > kWalls.max_furniture_depth_m)
      continue;
    if (wall.length() < kWalls.min_wall_beside_m || -shared_length(plane, wall) >= kWalls.beside_m) continue;
    before = distance;
  }
  return before;
}

/// The height up to which a room's walls are seen without a ceiling: that of its long walls, where
/// they agree. Tops that only the view ends at differ from wall to wall.
std::optional<double> top_of_room(const std::vector<WallCandidate>& walls) {
  std::vector<double> tops;
  for (const WallCandidate& wall : walls)
    if (wall.patch.plane.length() > kWalls.cupboard_side_m) tops.push_back(wall.patch.plane.top);
  std::ranges::sort(tops, std::greater{});
  if (tops.size() < kWalls.min_tops || tops.front() - tops[kWalls.min_tops - 1] > kWalls.same_top_m)
    return std::nullopt;
  return tops.front();
}

/// Why a plane of full height is not a wall; empty when it is one. `top`: of the room.
std::string why_no_wall(const VerticalPlane& plane, const std::vector<WallCandidate>& walls,
                        const Surface& surface, double floor_height, std::optional<double> top,
                        const InterpretationOptions& options) {
  // What reaches the top of the room may be narrow: a pillar, the side of a chimney. Reveals end lower.
  const bool at_top = top && plane.top > *top - kWalls.at_ceiling_m;
  if (!at_top && plane.area < options.min_wall_area_m2)
    return fmt::format("only {:.2f} m2 were seen", plane.area);
  if (plane.length() < (at_top ? kWalls.min_pillar_m : kWalls.min_length_m))
    return fmt::format("it is only {:.2f} m wide", plane.length());
  for (const WallCandidate& other : walls)
    if (&other.patch.plane != &plane && is_window_pane(plane, other.patch.plane, floor_height))
      return "it closes an opening of a wall";
  const double before = depth_before_wall(plane, walls);
  if (before > 0 && (!at_top || has_fixtures(surface, plane)))
    return fmt::format("it stands {:.2f} m before one, as furniture does", before);
  return {};
}

/// Turns narrow faces square to the longest wall where they are nearly so: some centimetres of noise turn a
/// pillar's face by degrees.
void square_narrow(std::vector<VerticalPlane>& walls) {
  const auto longest = std::ranges::max_element(walls, {}, &VerticalPlane::length);
  if (longest == walls.end()) return;
  const Vector2d normal = longest->normal, along = longest->direction();
  for (VerticalPlane& wall : walls) {
    if (wall.length() > kWalls.narrow_m) continue;
    for (const Vector2d& square : {normal, Vector2d(-normal), along, Vector2d(-along)}) {
      if (wall.normal.dot(square) < kWalls.narrow_cosine) continue;
      const Vector2d middle = middle_of(wall);
      const double half = wall.length() / 2;
      wall.normal = square;
      wall.offset = square.dot(middle);
      const double centre = wall.direction().dot(middle);
      wall.along_min = centre - half;
      wall.along_max = centre + half;
    }
  }
}

/// Extends walls that end just before another to where their planes meet: surfels there mix both.
void close_corners(std::vector<VerticalPlane>& walls) {
  for (VerticalPlane& wall : walls)
    for (const VerticalPlane& other : walls) {
      const double across = wall.direction().dot(other.normal);
      if (std::abs(across) < kWalls.min_corner_sine) continue;
      const double along = (other.offset - other.normal.dot(wall.at(0))) / across;
      const double on_other = other.direction().dot(wall.at(along));
      if (on_other < other.along_min - kWalls.corner_m || on_other > other.along_max + kWalls.corner_m)
        continue;
      if (along < wall.along_min && along > wall.along_min - kWalls.corner_m) wall.along_min = along;
      if (along > wall.along_max && along < wall.along_max + kWalls.corner_m) wall.along_max = along;
    }
}

}  // namespace

WallSearch find_walls(const Surface& surface, double floor_height, std::optional<double> ceiling,
                      const InterpretationOptions& options) {
  std::vector<Surfel> surfels = surfels_of(surface);
  std::vector<WallCandidate> all;
  std::vector<VerticalPlane> planes;
  for (PlanePatch& patch : vertical_planes(surfels, options)) {
    patch.plane.behind = seen_behind(surfels, patch.plane, floor_height);
    planes.push_back(patch.plane);
    all.push_back({std::move(patch), {}});
  }
  const std::vector<RayEvidence> rays = ray_evidence(surface, planes, options.threads);
  WallSearch result;
  std::vector<WallCandidate> walls;
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].rays = rays[i];
    const VerticalPlane& plane = all[i].patch.plane;
    const std::string why = why_not_full_height(all[i], floor_height, ceiling, surface.free_space, options);
    if (why.empty()) {
      walls.push_back(all[i]);
    } else {
      result.notes.push_back(described(plane) + why);
      result.others.push_back(plane);
    }
  }
  unite_pieces(walls, surfels, all);
  const std::optional<double> top = ceiling ? ceiling : top_of_room(walls);
  for (const WallCandidate& wall : walls) {
    const VerticalPlane& plane = wall.patch.plane;
    const std::string why = why_no_wall(plane, walls, surface, floor_height, top, options);
    if (!why.empty()) result.notes.push_back(described(plane) + why);
    (why.empty() ? result.walls : result.others).push_back(plane);
  }
  parallel_for(result.walls.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) refine_wall(result.walls[i], surface);
  });
  square_narrow(result.walls);
  close_corners(result.walls);
  return result;
}

double yaw_of_walls(const std::vector<VerticalPlane>& walls, double rough_yaw) {
  double turn = 0, area = 0;
  for (const VerticalPlane& wall : walls) {
    const double off = std::remainder(std::atan2(wall.normal.y(), wall.normal.x()) - rough_yaw, kPi / 2);
    if (std::abs(off) > kLevels.wall_yaw) continue;
    turn += wall.area * off;
    area += wall.area;
  }
  return area > 0 ? rough_yaw + turn / area : rough_yaw;
}

}  // namespace loci::mapping
