#include "mapping/interpretation/fronts/fronts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/fronts/face.h"
#include "mapping/interpretation/fronts/front_layout.h"
#include "mapping/interpretation/fronts/parameters.h"
#include "mapping/interpretation/fronts/ribs.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {
namespace {

/// Whether the front returns much less intensity than the rest of its face.
bool is_dark(const FaceRect& rect, const FaceRays& rays) {
  std::vector<float> own, rest;
  for (const FaceRay& ray : rays.rays) {
    if (ray.is_on_face()) (rect.contains(ray, -0.02) ? own : rest).push_back(ray.appearance[0]);
  }
  return own.size() > kFronts.min_rays && rest.size() > kFronts.min_rays &&
         static_cast<double>(median(own)) < kFronts.dark * static_cast<double>(median(rest));
}

bool between(double value, double low, double high) {
  return value >= low && value <= high;
}

/// The appliance behind a front, by shape, place, handle and appearance: "oven" (a dark pane of the standard
/// width among lighter fronts), "fridge" (a tall narrow front with a long upright handle). Empty where the
/// evidence does not suffice: the front of a dishwasher equals that of a cupboard.
std::string appliance_of(const Front& front, const FaceRect& rect, const FaceRays& rays) {
  const bool handle = front.fixture && front.fixture->kind == Fixture::Kind::handle;
  const bool upright = handle && std::abs(front.fixture->axis.z()) > 0.9;
  if (between(front.width, 0.52, 0.66) && between(front.height, 0.35, 0.65) && !upright &&
      is_dark(rect, rays))
    return "oven";
  if (upright && front.fixture->length > 0.3 && between(front.width, 0.45, 0.95) &&
      between(front.height, 0.8, 2.0) && rect.v1 > 1.3)
    return "fridge";
  return {};
}

struct FaceResult {
  std::vector<Front> fronts;
  std::vector<Fixture> ribs;
  std::vector<std::string> notes;
};

/// The median depth of a front against the plane of its face.
double depth_of(const FaceRect& rect, const FaceRays& rays) {
  std::vector<float> depths;
  for (const FaceRay& ray : rays.rays)
    if (ray.is_on_face() && rect.contains(ray, kFronts.depth_inset_m)) depths.push_back(ray.depth);
  if (depths.empty()) return 0;
  return static_cast<double>(median(std::move(depths)));
}

/// By how much a front comes out of its face per metre to the right: a face that spans two planes leans.
double slope_of(const FaceRect& rect, const FaceRays& rays) {
  double count = 0, u_sum = 0, depth_sum = 0, uu = 0, ud = 0;
  for (const FaceRay& ray : rays.rays) {
    if (!ray.is_on_face() || !rect.contains(ray, kFronts.depth_inset_m)) continue;
    const double u = ray.point_u() - rect.u(), depth = static_cast<double>(ray.depth);
    count += 1;
    u_sum += u;
    depth_sum += depth;
    uu += u * u;
    ud += u * depth;
  }
  const double spread = count * uu - u_sum * u_sum;
  return spread > 0 ? (count * ud - u_sum * depth_sum) / spread : 0;
}

Front front_of(const PlacedFront& placed, const FaceRays& rays, const std::vector<FaceFixture>& fixtures) {
  const FurnitureFace& face = rays.face;
  Front front;
  const double depth = depth_of(placed.rect, rays);
  front.centre = face.at(placed.rect.u(), placed.rect.v(), depth);
  front.normal = face.normal3();
  front.width = placed.rect.width();
  front.height = placed.rect.height();
  front.confidence = placed.confidence;
  if (placed.fixture >= 0) {
    front.fixture = fixtures[static_cast<size_t>(placed.fixture)].fixture;
    front.fixture->protrusion = front.normal.dot(front.fixture->centre - front.centre);
    front.confidence *= 0.5 + 0.5 * front.fixture->confidence;
  }
  front.appliance = appliance_of(front, placed.rect, rays);
  std::vector<size_t> points(1);
  std::vector<int> scans;
  for (const FaceRay& ray : rays.rays) {
    if (!ray.is_on_face() || !placed.rect.contains(ray)) continue;
    points.resize(std::max<size_t>(points.size(), ray.scan + size_t{1}));
    ++points[ray.scan];
  }
  size_t inliers = 0;
  for (size_t scan = 0; scan < points.size(); ++scan) {
    inliers += points[scan];
    if (points[scan] > 20) scans.push_back(static_cast<int>(scan));
  }
  Json edges = Json::object();
  const std::array<const char*, 4> names = {"left", "right", "bottom", "top"};
  for (size_t side = 0; side < 4; ++side) edges[names[side]] = front_edge_name(placed.edges[side].kind);
  Json scores = Json::array();
  for (const FrontEdge& edge : placed.edges) scores.push_back(std::round(10 * edge.z) / 10);
  front.evidence = {{"inliers", inliers}, {"scans", scans}, {"edges", edges}, {"edge_scores", scores}};
  front.evidence["slope"] = std::round(1e4 * slope_of(placed.rect, rays)) / 1e4;
  return front;
}

bool is_resolved(const FrontEdge& edge) {
  return edge.kind == FrontEdge::Kind::seam || edge.kind == FrontEdge::Kind::step;
}

int resolved_edges(const PlacedFront& front) {
  return static_cast<int>(std::ranges::count_if(front.edges, is_resolved));
}

/// Whether a front is the low drawer over the plinth (below an oven): the plinth recedes from it.
bool is_plinth_drawer(const PlacedFront& front) {
  const FrontEdge& below = front.edges[2];
  return front.rect.height() < front.rect.width() && is_resolved(below) && below.rise > kFronts.min_plinth_m;
}

/// Whether a front is accepted. On walls (tall furniture may hide the wall and be taken for it) it needs a
/// certain fixture and resolved edges.
bool is_accepted(const PlacedFront& front, const std::vector<FaceFixture>& fixtures, bool wall) {
  const FaceRect& rect = front.rect;
  if (rect.width() > kFronts.max_width_m || rect.width() * rect.height() > kFronts.max_area_m2) return false;
  if (std::min(rect.width(), rect.height()) <
      (front.fixture < 0 && !is_plinth_drawer(front) ? kFronts.min_bare_side_m : kFronts.min_side_m))
    return false;
  if (rect.height() > rect.width() && rect.width() < kFronts.min_upright_m) return false;
  if (!wall) return true;
  return front.fixture >= 0 && resolved_edges(front) >= kFronts.min_wall_edges &&
         fixtures[static_cast<size_t>(front.fixture)].fixture.confidence >
             kFronts.min_wall_fixture_confidence;
}

/// Whether boards stand out from the edges of a front, on three sides or more: it is the back of open
/// shelves.
bool is_in_niche(const FaceRect& rect, const FaceRays& rays) {
  constexpr size_t kSides = 4, kSteps = kFronts.niche_steps;
  std::array<std::array<size_t, kSteps>, kSides> points{};
  for (const FaceRay& ray : rays.rays) {
    const double depth = static_cast<double>(ray.depth) - kFaces.relief_m;
    if (!ray.returned || depth < 0 || !rect.contains(ray.point_u(), ray.point_v(), kFronts.niche_edge_m))
      continue;
    const auto step = static_cast<size_t>(depth / kFronts.niche_step_m);
    if (step >= kSteps) continue;
    const std::array<double, kSides> inside = {ray.point_u() - rect.u0, rect.u1 - ray.point_u(),
                                               ray.point_v() - rect.v0, rect.v1 - ray.point_v()};
    for (size_t side = 0; side < kSides; ++side)
      if (std::abs(inside[side]) < kFronts.niche_edge_m) ++points[side][step];
  }
  return std::ranges::count_if(points, [](const auto& steps) {
           return std::ranges::all_of(steps, [](size_t n) { return n >= kFronts.niche_points; });
         }) >= 3;
}

FaceResult interpret_face(const FaceRays& rays, bool wall, const Random& random) {
  FaceResult result;
  if (rays.sigma > kFronts.max_sigma_m) return result;
  FixtureSearch found = find_fixtures(rays, random);
  result.ribs = found.ribs;
  std::erase_if(found.fixtures, [](const FaceFixture& fixture) {
    return fixture.fixture.confidence < kFronts.min_fixture_confidence;
  });
  if (wall && found.fixtures.empty()) return result;
  const SeamMap seams(rays, found.fixtures);
  const FrontLayout layout = lay_out_fronts(seams, rays.face, found.fixtures);
  for (const PlacedFront& placed : layout.fronts)
    if (is_accepted(placed, found.fixtures, wall) &&
        std::abs(slope_of(placed.rect, rays)) < kFronts.max_slope &&
        (placed.fixture >= 0 || !is_in_niche(placed.rect, rays)))
      result.fronts.push_back(front_of(placed, rays, found.fixtures));
  if (wall && result.fronts.size() < kFronts.min_wall_fronts) result.fronts.clear();
  if (result.fronts.empty() && result.ribs.empty())
    return result;  // not furniture: no notes about its fixtures
  result.notes = found.notes;
  for (const size_t i : layout.unassigned) {
    const Vector3d& at = found.fixtures[i].fixture.centre;
    result.notes.push_back(fmt::format(
        "the possible fixture at ({:.2f}, {:.2f}, {:.2f}) has no front around it", at.x(), at.y(), at.z()));
  }
  return result;
}

/// Whether a face is a piece of a wall.
bool is_wall(const FurnitureFace& face, const std::vector<VerticalPlane>& walls) {
  const Vector2d middle = face.at((face.u_min + face.u_max) / 2, 0).head<2>();
  return std::any_of(walls.begin(), walls.end(), [&](const VerticalPlane& wall) {
    const double along = wall.direction().dot(middle);
    return wall.normal.dot(face.normal) > 0.99 &&
           std::abs(wall.normal.dot(middle) - wall.offset) < kFronts.same_wall_m &&
           along > wall.along_min - kFronts.same_wall_m && along < wall.along_max + kFronts.same_wall_m;
  });
}

/// Whether a front would stand in a wall: a plane through the edge of a wall and what is before it shows one.
bool is_in_a_wall(const Front& front, const std::vector<VerticalPlane>& walls) {
  const Vector2d middle = front.centre.head<2>();
  return std::ranges::any_of(walls, [&](const VerticalPlane& wall) {
    const double along = wall.direction().dot(middle), before = wall.normal.dot(middle) - wall.offset;
    return wall.normal.dot(front.normal.head<2>()) < kFaces.parallel_cosine && before < -kFronts.in_wall_m &&
           before > -kFronts.behind_wall_m && along > wall.along_min && along < wall.along_max;
  });
}

/// The share of the smaller front that the other one covers, in the plane of the first.
double covered(const Front& a, const Front& b) {
  const Vector3d off = b.centre - a.centre;
  const auto shared = [](double distance, double size_a, double size_b) {
    return std::max(0.0, std::min({size_a, size_b, (size_a + size_b) / 2 - std::abs(distance)}));
  };
  return shared(off.dot(a.right()), a.width, b.width) * shared(off.dot(a.up), a.height, b.height) /
         std::min(a.width * a.height, b.width * b.height);
}

/// Whether a front begins behind an edge of another one and goes back from there.
bool is_beside(const Front& front, const Front& other) {
  if (std::abs(front.normal.dot(other.normal)) > kFronts.max_corner_cosine) return false;
  const Vector3d off = front.centre - other.centre;
  const double gap = off.dot(front.normal) - other.width / 2,
               begin = -off.dot(other.normal) - front.width / 2,
               shared = (front.height + other.height) / 2 - std::abs(off.z());
  return std::abs(gap) < kFronts.max_corner_m && std::abs(begin) < kFronts.max_corner_m &&
         shared > std::min(front.height, other.height) / 2;
}

/// Where scans lie apart by more than their noise, a face is found twice, and so are its fronts: the one with
/// more evidence stays.
void drop_duplicates(std::vector<Front>& fronts) {
  const auto points = [](const Front& front) { return front.evidence.at("inliers").get<size_t>(); };
  const auto is_weaker_twin = [&](const Front& front) {
    return std::any_of(fronts.begin(), fronts.end(), [&](const Front& other) {
      return &other != &front && front.normal.dot(other.normal) > kFaces.parallel_cosine &&
             std::abs(front.normal.dot(other.centre - front.centre)) < kFronts.same_front_m &&
             covered(front, other) > kFronts.same_front_cover &&
             std::pair(points(front), &front) < std::pair(points(other), &other);
    });
  };
  std::vector<Front> kept;
  std::copy_if(fronts.begin(), fronts.end(), std::back_inserter(kept),
               [&](const Front& front) { return !is_weaker_twin(front); });
  fronts = std::move(kept);
}

}  // namespace

FrontSearch find_fronts(const Surface& surface, double floor_height, const WallSearch& vertical,
                        const InterpretationOptions& options, Progress& progress) {
  FrontSearch search;
  search.faces = find_faces(surface, floor_height);
  std::vector<FurnitureFace>& faces = search.faces;
  for (FurnitureFace& face : faces) face.wall = is_wall(face, vertical.walls);
  progress.check(0.2, "furniture faces");
  // One face at a time: the rays of all of them take more memory than the scans.
  std::vector<FaceResult> results(faces.size());
  const Random random(kFronts.seed);
  parallel_for(faces.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      results[i] =
          interpret_face(gather_rays(surface, faces[i], floor_height), faces[i].wall, random.fork(i));
  });
  for (const FaceResult& result : results)
    search.ribs.insert(search.ribs.end(), result.ribs.begin(), result.ribs.end());
  for (const FaceResult& result : results) {
    std::copy_if(result.fronts.begin(), result.fronts.end(), std::back_inserter(search.fronts),
                 [&](const Front& front) {
                   return !is_of_ribs(front, search.ribs) && !is_in_a_wall(front, vertical.walls);
                 });
    search.notes.insert(search.notes.end(), result.notes.begin(), result.notes.end());
  }
  drop_duplicates(search.fronts);
  drop_side_panels(search.fronts);
  return search;
}

void drop_side_panels(std::vector<Front>& fronts) {
  std::vector<Front> kept;
  std::ranges::copy_if(fronts, std::back_inserter(kept), [&](const Front& front) {
    return std::ranges::none_of(fronts, [&](const Front& other) {
      return other.confidence > front.confidence && is_beside(front, other);
    });
  });
  fronts = std::move(kept);
}

}  // namespace loci::mapping
