#include "mapping/interpretation/walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/parallel.h"
#include "mapping/interpretation/vertical_planes.h"
#include "mapping/interpretation/wall_evidence.h"

namespace loci::mapping {
namespace {

constexpr double kColumn = 0.05;        // m
constexpr double kBehind = 0.12;        // m; what lies farther behind a plane was seen round or through it
constexpr double kMaxBehind = 0.35;     // windows and doors let one look behind a part of a wall
constexpr double kMaxPassedOver = 0.3;  // of its length; furniture is lower than the room
constexpr double kLookedOver = 0.3;     // of its length, which is enough to know
constexpr double kMaxPierced = 0.6;     // of its area; a wall may have large windows
constexpr double kAtCeiling = 0.12;     // m
constexpr double kBelowCeiling = 0.25;  // m
constexpr double kCupboardSide = 1.0;  // m; narrower planes that end below the ceiling are sides of furniture
constexpr double kNarrow = 0.3;        // m; narrower planes are reveals of windows and doors, or pillars
constexpr double kParallel = 0.9995;   // cosine of 1.8°
constexpr double kSamePlane = 0.025;   // m between pieces of one wall
constexpr double kDoor = 1.3;          // m; a gap in a wall that a door makes
constexpr double kDeepestWindow = 0.5;  // m from a wall's face to the pane
constexpr double kShallowestWindow = 0.03;

/// A plane on trial.
struct Candidate {
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
  const auto columns = static_cast<size_t>((plane.length() - 2 * margin) / kColumn) + 1;
  std::vector<int> behind(columns, 0);
  for (const Surfel& surfel : surfels) {
    if (surfel.position.z() < floor_height + 0.1) continue;
    const double depth = plane.offset - plane.normal.dot(surfel.position.head<2>());
    if (depth < kBehind || depth > 4) continue;
    const double along = plane.direction().dot(surfel.position.head<2>()) - plane.along_min - margin;
    if (along < 0 || along >= static_cast<double>(columns) * kColumn) continue;
    ++behind[static_cast<size_t>(along / kColumn)];
  }
  const auto seen = std::count_if(behind.begin(), behind.end(), [](int count) { return count >= 3; });
  return static_cast<double>(seen) / static_cast<double>(columns);
}

/// Why a plane does not stand like a wall, from floor to ceiling; empty when it does.
std::string why_not_upright(const Candidate& candidate, double floor_height, std::optional<double> ceiling,
                            bool free_space, const InterpretationOptions& options) {
  const VerticalPlane& plane = candidate.patch.plane;
  if (plane.top < floor_height + options.wall_min_top_m)
    return fmt::format("its top is at {:.2f} m", plane.top);
  if (free_space && candidate.rays.passed_over > kMaxPassedOver)
    return fmt::format("something was seen over {:.0f} % of its length", 100 * candidate.rays.passed_over);
  if (free_space && candidate.rays.pierced > kMaxPierced)
    return fmt::format("rays passed through {:.0f} % of it", 100 * candidate.rays.pierced);
  if (ceiling && plane.top < *ceiling - kBelowCeiling && plane.length() < kCupboardSide)
    return fmt::format("it is {:.2f} m wide and ends {:.2f} m below the ceiling", plane.length(),
                       *ceiling - plane.top);
  const bool full_height = (ceiling && plane.top > *ceiling - kAtCeiling) ||
                           (free_space && candidate.rays.looked_over > kLookedOver);
  if (!full_height && plane.behind > kMaxBehind)
    return fmt::format("something was seen behind {:.0f} % of its length", 100 * plane.behind);
  return {};
}

/// Whether b goes on where a ends, in the same plane, with a door between them at most, or a window: a pane
/// or a niche a little behind.
bool continues(const VerticalPlane& a, const VerticalPlane& b, const std::vector<Candidate>& all) {
  if (a.normal.dot(b.normal) < kParallel) return false;
  const double between = std::max(std::abs(a.normal.dot(middle_of(b)) - a.offset),
                                  std::abs(b.normal.dot(middle_of(a)) - b.offset));
  const double gap = -shared_length(a, b);
  if (gap < -0.1 || between > kSamePlane + 0.01 * std::max(0.0, gap)) return false;
  if (gap < kDoor) return true;
  VerticalPlane opening = a;
  const double start = a.direction().dot(middle_of(b)) > a.along_max ? a.along_max : a.along_min - gap;
  opening.along_min = start;
  opening.along_max = start + gap;
  return std::any_of(all.begin(), all.end(), [&](const Candidate& other) {
    const VerticalPlane& pane = other.patch.plane;
    const double depth = opening.offset - opening.normal.dot(middle_of(pane));
    return pane.normal.dot(a.normal) > kParallel && depth > kShallowestWindow && depth < kDeepestWindow &&
           shared_length(opening, pane) > 0.5 * gap;
  });
}

void unite_pieces(std::vector<Candidate>& walls, const std::vector<Surfel>& surfels,
                  const std::vector<Candidate>& all) {
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

/// Whether a plane is the pane of a window in a wall: a little behind it, and not as high as it.
bool in_opening(const VerticalPlane& pane, const VerticalPlane& wall, double floor_height) {
  if (pane.normal.dot(wall.normal) < kParallel) return false;
  const double depth = wall.offset - wall.normal.dot(middle_of(pane));
  if (depth < kShallowestWindow || depth > kDeepestWindow) return false;
  const bool lower = pane.top < wall.top - 0.1 || pane.bottom > floor_height + 0.3;
  return lower && shared_length(wall, pane) > 0.9 * pane.length();
}

/// A plane that stands at the depth of furniture before a wall of the same direction, which goes on beside
/// it, is the front of tall furniture; where it reaches the ceiling, only if something to open it by stands
/// out of it.
double depth_before_wall(const VerticalPlane& plane, const std::vector<Candidate>& walls) {
  constexpr double kShallowest = 0.25;
  constexpr double kDeepest = 0.8;
  constexpr double kBeside = 0.5;     // m between the two along the wall
  constexpr double kMinLength = 0.8;  // m; less may be a niche in the wall
  double before = 0;
  for (const Candidate& other : walls) {
    const VerticalPlane& wall = other.patch.plane;
    const double distance = wall.normal.dot(middle_of(plane)) - wall.offset;
    if (wall.normal.dot(plane.normal) < 0.99 || distance < kShallowest || distance > kDeepest) continue;
    if (wall.length() < kMinLength || -shared_length(plane, wall) >= kBeside) continue;
    before = distance;
  }
  return before;
}

/// Why a plane that stands like a wall is none; empty when it is one.
std::string why_no_wall(const VerticalPlane& plane, const std::vector<Candidate>& walls,
                        const Surface& surface, double floor_height, std::optional<double> ceiling,
                        const InterpretationOptions& options) {
  if (plane.area < options.wall_min_area_m2) return fmt::format("only {:.2f} m2 were seen", plane.area);
  if (plane.length() < kNarrow) return fmt::format("it is only {:.2f} m wide", plane.length());
  for (const Candidate& other : walls)
    if (&other.patch.plane != &plane && in_opening(plane, other.patch.plane, floor_height))
      return "it closes an opening of a wall";
  const double before = depth_before_wall(plane, walls);
  const bool at_ceiling = ceiling && plane.top > *ceiling - kAtCeiling;
  if (before > 0 && (!at_ceiling || has_fixtures(surface, plane)))
    return fmt::format("it stands {:.2f} m before one, as furniture does", before);
  return {};
}

}  // namespace

WallSearch find_walls(const Surface& surface, double floor_height, std::optional<double> ceiling,
                      const InterpretationOptions& options) {
  std::vector<Surfel> surfels = surfels_of(surface);
  std::vector<Candidate> all;
  std::vector<VerticalPlane> planes;
  for (PlanePatch& patch : vertical_planes(surfels, options)) {
    patch.plane.behind = seen_behind(surfels, patch.plane, floor_height);
    planes.push_back(patch.plane);
    all.push_back({std::move(patch), {}});
  }
  const std::vector<RayEvidence> rays = ray_evidence(surface, planes, options.threads);
  WallSearch result;
  std::vector<Candidate> walls;
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].rays = rays[i];
    const VerticalPlane& plane = all[i].patch.plane;
    const std::string why = why_not_upright(all[i], floor_height, ceiling, surface.free_space, options);
    if (why.empty()) {
      walls.push_back(all[i]);
    } else {
      result.notes.push_back(described(plane) + why);
      result.others.push_back(plane);
    }
  }
  unite_pieces(walls, surfels, all);
  for (const Candidate& wall : walls) {
    const VerticalPlane& plane = wall.patch.plane;
    const std::string why = why_no_wall(plane, walls, surface, floor_height, ceiling, options);
    if (!why.empty()) result.notes.push_back(described(plane) + why);
    (why.empty() ? result.walls : result.others).push_back(plane);
  }
  parallel_for(result.walls.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) polish(result.walls[i], surface);
  });
  return result;
}

}  // namespace loci::mapping
