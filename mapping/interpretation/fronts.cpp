#include "mapping/interpretation/fronts.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/json.h"
#include "mapping/base/parallel.h"
#include "mapping/base/quantile.h"
#include "mapping/interpretation/appliances.h"
#include "mapping/interpretation/front_layout.h"

namespace loci::mapping {
namespace {

constexpr uint64_t kSeed = 7;            // of the sample consensus
constexpr double kSameWall = 0.08;       // m
constexpr double kWidest = 1.4;          // m; wider is no front
constexpr double kMax = 2.2;             // m²
constexpr double kNarrowest = 0.07;      // m
constexpr double kNarrowestBare = 0.12;  // m, without a fixture: narrower ones are strips that fill a gap
constexpr double kMaxScatter = 0.015;    // m; more are corners and clutter, and handles would drown in it
constexpr double kMinSure = 0.4;         // of a fixture
constexpr double kSureOnWall = 0.75;     // of a fixture
constexpr size_t kMinOnWall = 2;         // fronts
constexpr int kResolvedOnWall = 3;       // edges

struct FaceResult {
  std::vector<Front> fronts;
  std::vector<std::string> notes;
};

/// The median depth of a front against the plane of its face.
double depth_of(const FaceRect& rect, const FaceRays& rays) {
  constexpr double kMargin = -0.01;  // m
  std::vector<float> depths;
  for (const FaceRay& ray : rays.rays)
    if (ray.returned && std::abs(ray.depth) < static_cast<float>(kFaceRelief) &&
        rect.contains(static_cast<double>(ray.u), static_cast<double>(ray.v), kMargin))
      depths.push_back(ray.depth);
  if (depths.empty()) return 0;
  return static_cast<double>(median(std::move(depths)));
}

Front front_of(const PlacedFront& placed, const FaceRays& rays, const std::vector<FaceFixture>& fixtures) {
  const Face& face = rays.face;
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
    if (!ray.returned || std::abs(ray.depth) > static_cast<float>(kFaceRelief)) continue;
    if (!placed.rect.contains(static_cast<double>(ray.u), static_cast<double>(ray.v))) continue;
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
  return front;
}

int resolved_edges(const PlacedFront& front) {
  return static_cast<int>(std::count_if(front.edges.begin(), front.edges.end(), [](const FrontEdge& edge) {
    return edge.kind == FrontEdge::Kind::seam || edge.kind == FrontEdge::Kind::step;
  }));
}

/// Whether a front is believed. On what was taken for a wall (tall furniture may hide the wall altogether)
/// only fronts with sure fixtures whose edges were resolved are.
bool believed(const PlacedFront& front, const std::vector<FaceFixture>& fixtures, bool wall) {
  const FaceRect& rect = front.rect;
  if (rect.width() > kWidest || rect.width() * rect.height() > kMax) return false;
  if (std::min(rect.width(), rect.height()) < (front.fixture < 0 ? kNarrowestBare : kNarrowest)) return false;
  if (!wall) return true;
  return front.fixture >= 0 && resolved_edges(front) >= kResolvedOnWall &&
         fixtures[static_cast<size_t>(front.fixture)].fixture.confidence > kSureOnWall;
}

FaceResult interpret_face(const FaceRays& rays, bool wall, const Random& random) {
  FaceResult result;
  if (rays.sigma > kMaxScatter) return result;
  FixtureSearch found = find_fixtures(rays, random);
  std::erase_if(found.fixtures,
                [](const FaceFixture& fixture) { return fixture.fixture.confidence < kMinSure; });
  if (wall && found.fixtures.empty()) return result;
  const SeamMap seams(rays, found.fixtures);
  const FrontLayout layout = lay_out_fronts(seams, rays.face, found.fixtures);
  for (const PlacedFront& placed : layout.fronts)
    if (believed(placed, found.fixtures, wall))
      result.fronts.push_back(front_of(placed, rays, found.fixtures));
  if (wall && result.fronts.size() < kMinOnWall) result.fronts.clear();
  if (result.fronts.empty()) return result;  // not furniture: what hangs before it is no near miss
  result.notes = found.notes;
  for (const size_t i : layout.homeless) {
    const Vector3d& at = found.fixtures[i].fixture.centre;
    result.notes.push_back(
        fmt::format("what looks like a fixture at ({:.2f}, {:.2f}, {:.2f}) has no front around it", at.x(),
                    at.y(), at.z()));
  }
  return result;
}

/// Whether a face is a piece of a wall.
bool is_wall(const Face& face, const std::vector<VerticalPlane>& walls) {
  const Vector2d middle = face.at((face.u_min + face.u_max) / 2, 0).head<2>();
  return std::any_of(walls.begin(), walls.end(), [&](const VerticalPlane& wall) {
    const double along = wall.direction().dot(middle);
    return wall.normal.dot(face.normal) > 0.99 &&
           std::abs(wall.normal.dot(middle) - wall.offset) < kSameWall &&
           along > wall.along_min - kSameWall && along < wall.along_max + kSameWall;
  });
}

}  // namespace

FrontSearch find_fronts(const Surface& surface, double floor_height, const WallSearch& vertical,
                        const InterpretationOptions& options, Progress& progress) {
  const std::vector<Face> faces = find_faces(surface, floor_height);
  progress.check(0.2, "furniture faces");
  std::vector<FaceRays> rays(faces.size());
  parallel_for(faces.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) rays[i] = gather_rays(surface, faces[i], floor_height);
  });
  progress.check(0.5, "furniture fronts");
  std::vector<FaceResult> results(rays.size());
  const Random random(kSeed);
  parallel_for(rays.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      results[i] = interpret_face(rays[i], is_wall(rays[i].face, vertical.walls), random.fork(i));
  });
  FrontSearch search;
  for (const FaceResult& result : results) {
    search.fronts.insert(search.fronts.end(), result.fronts.begin(), result.fronts.end());
    search.notes.insert(search.notes.end(), result.notes.begin(), result.notes.end());
  }
  return search;
}

}  // namespace loci::mapping
