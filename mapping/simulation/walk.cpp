#include "mapping/simulation/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "mapping/base/math/math.h"
#include "mapping/render/ray_scene.h"
#include "mapping/simulation/scenario.h"
#include "mapping/world/inspection.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

constexpr double kStep = 0.15;    ///< between places that are tried
constexpr double kSpacing = 0.8;  ///< between places where the person turns round
constexpr double kBody = 0.2;     ///< radius
constexpr double kFeet = 0.05, kHead = 1.7;
constexpr double kEyes = 1.25;         ///< height at which walls are looked for
constexpr double kMinEnclosed = 0.6;   ///< of the directions, that end at something
constexpr double kMinClearance = 0.3;  ///< before the body is tested exactly
constexpr int kDirections = 24;
constexpr float kFar = 10;
constexpr int kYaws = 12;

struct Gesture {
  double height, pitch_deg;
};
/// Base cabinets from above and from before them, and wall cupboards.
constexpr std::array<Gesture, 3> kGestures = {{{1.5, -32}, {0.9, -12}, {1.4, 12}}};

Vector3d direction_of(double yaw, double pitch) {
  return {std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch)};
}

/// Whether a person can stand at a place inside the world.
bool can_stand(const RayScene& scene, const Vector2d& place) {
  int walled = 0;
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector3f along = direction_of(2 * kPi * i / kDirections, 0).cast<float>();
    const Vector3d eyes(place.x(), place.y(), kEyes);
    const RayHit hit = scene.cast(eyes.cast<float>(), along, kFar);
    if (hit.link < 0) continue;
    if (static_cast<double>(hit.distance) < kMinClearance) return false;
    ++walled;
  }
  return walled > kMinEnclosed * kDirections && scene.link_in_cylinder(place, kBody, kFeet, kHead) < 0;
}

/// The largest set of places that are connected by steps.
std::vector<Vector2d> connected(const std::vector<Vector2d>& places) {
  std::vector<Vector2d> best;
  std::vector<bool> known(places.size(), false);
  for (size_t first = 0; first < places.size(); ++first) {
    if (known[first]) continue;
    std::vector<Vector2d> group = {places[first]};
    known[first] = true;
    for (size_t next = 0; next < group.size(); ++next)
      for (size_t i = 0; i < places.size(); ++i)
        if (!known[i] && (places[i] - group[next]).norm() < 1.1 * kStep) {
          known[i] = true;
          group.push_back(places[i]);
        }
    if (group.size() > best.size()) best = std::move(group);
  }
  return best;
}

/// Places `spacing` apart that cover a set, each the farthest from those before.
std::vector<Vector2d> spread(const std::vector<Vector2d>& places, double spacing) {
  std::vector<Vector2d> chosen = {places.front()};
  std::vector<double> distance(places.size(), std::numeric_limits<double>::infinity());
  for (;;) {
    for (size_t i = 0; i < places.size(); ++i)
      distance[i] = std::min(distance[i], (places[i] - chosen.back()).norm());
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (*farthest < spacing) return chosen;
    chosen.push_back(places[static_cast<size_t>(farthest - distance.begin())]);
  }
}

/// The places in the order of a walk: always to the nearest that is left.
void order(std::vector<Vector2d>& places) {
  for (size_t i = 1; i < places.size(); ++i)
    std::iter_swap(places.begin() + static_cast<std::ptrdiff_t>(i),
                   std::min_element(places.begin() + static_cast<std::ptrdiff_t>(i), places.end(),
                                    [&](const Vector2d& a, const Vector2d& b) {
                                      return (a - places[i - 1]).norm() < (b - places[i - 1]).norm();
                                    }));
}

}  // namespace

std::vector<Vector2d> standing_places(const World& world, const MeshSearch& search, Warnings& warnings) {
  RayScene scene;
  scene.add(world, search, Isometry3d::Identity(), warnings);
  const Eigen::AlignedBox3d box = scene.bounds();
  require_metres(box, world.name);
  std::vector<Vector2d> places;
  for (double y = box.min().y(); !box.isEmpty() && y <= box.max().y(); y += kStep)
    for (double x = box.min().x(); x <= box.max().x(); x += kStep)
      if (can_stand(scene, {x, y})) places.emplace_back(x, y);
  if (places.empty()) throw Error("no place inside the world is open enough to stand in", {});
  places = spread(connected(places), kSpacing);
  order(places);
  return places;
}

std::vector<Isometry3d> views_from(const std::vector<Vector2d>& places) {
  std::vector<Isometry3d> views;
  for (const Vector2d& place : places)
    for (const Gesture& gesture : kGestures)
      for (int i = 0; i < kYaws; ++i) {
        const Vector3d from(place.x(), place.y(), gesture.height);
        views.push_back(
            looking_at(from, from + direction_of(2 * kPi * i / kYaws, gesture.pitch_deg * kDegree)));
      }
  return views;
}

std::vector<Isometry3d> stroll(const std::vector<Vector2d>& places, Random& random) {
  constexpr double kTurn = 3.5 * kDegree, kGo = 0.02;  // Per frame: 105 degrees and 0.6 m per second.
  constexpr double kBeside = 0.5 * kBody;
  std::vector<Isometry3d> views;
  double yaw = random.uniform(-kPi, kPi);
  const auto look = [&](const Vector2d& place) {
    const double phase = static_cast<double>(views.size()) / 12;
    const Vector3d from(place.x(), place.y(), 1.45 + 0.03 * std::sin(phase));
    const double pitch = (-20 + 14 * std::sin(0.31 * phase)) * kDegree;
    views.push_back(looking_at(from, from + direction_of(yaw, pitch)));
  };
  Vector2d at = places.front();
  for (const Vector2d& place : places) {
    const Vector2d to =
        place + Vector2d(random.uniform(-kBeside, kBeside), random.uniform(-kBeside, kBeside));
    const auto steps = static_cast<int>((to - at).norm() / kGo);
    for (int i = 1; i <= steps; ++i) look(at + (to - at) * i / steps);
    at = to;
    const double turn = random.uniform() < 0.5 ? kTurn : -kTurn;
    for (int i = 0; i < static_cast<int>(2 * kPi / kTurn); ++i) {
      yaw += turn;
      look(at);
    }
  }
  return views;
}

RecordResult record_views(const std::filesystem::path& world, std::vector<Isometry3d> map_from_camera,
                          TimeNs frame_interval, const std::filesystem::path& folder,
                          const RecordOptions& options, Progress& progress, Warnings& warnings) {
  Scenario scenario;
  scenario.file = scenario.world = world;
  scenario.camera = kinect_camera();
  scenario.frame_interval = frame_interval;
  if (read_urdf(world).find_link("floor") == nullptr) scenario.floor = 0;
  SceneSpec scene;
  scene.time_ns = parse_time("2026-05-01T06:00:00Z");
  scene.map_from_camera = std::move(map_from_camera);
  scenario.scenes = {scene};
  return record(scenario, folder, options, progress, warnings);
}

}  // namespace loci::mapping
