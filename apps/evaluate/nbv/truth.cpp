#include "apps/evaluate/nbv/truth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"

namespace loci::apps::nbv_evaluation {
namespace {

constexpr double kBodyBottom = 0.05;

/// Whether a robot can stand at a place: there is floor, and its body fits, by level rays at several heights
/// and rays down from its top.
bool fits(const mapping::RayScene& scene, const Vector2d& place, double radius, double top) {
  constexpr int kDirections = 24;
  const Eigen::Vector3f above = Vector3d(place.x(), place.y(), kBodyBottom).cast<float>();
  if (scene.cast(above, {0, 0, -1}, static_cast<float>(2 * kBodyBottom)).link < 0) return false;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * kPi * i / kDirections;
    const Eigen::Vector3f along(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0);
    for (double height = kBodyBottom + 0.05; height < top; height += 0.2)
      if (scene.cast(Vector3d(place.x(), place.y(), height).cast<float>(), along, static_cast<float>(radius))
              .link >= 0)
        return false;
    for (const double share : {0.0, 0.5, 0.95}) {
      const Eigen::Vector3f origin =
          Vector3d(place.x(), place.y(), top).cast<float>() + static_cast<float>(share * radius) * along;
      if (scene.cast(origin, {0, 0, -1}, static_cast<float>(top - kBodyBottom)).link >= 0) return false;
    }
  }
  return true;
}

std::vector<Vector2d> reachable_places(const mapping::RayScene& scene, const Vector2d& inside, double top,
                                       const TruthOptions& options) {
  CellIndex seen;
  std::vector<Vector2d> places;
  std::vector<Eigen::Vector2i> open{{0, 0}};
  seen.insert({0, 0, 0});
  while (!open.empty()) {
    const Eigen::Vector2i cell = open.back();
    open.pop_back();
    const Vector2d place = inside + options.step * cell.cast<double>();
    if (!fits(scene, place, options.robot_radius, top)) continue;
    places.push_back(place);
    if (places.size() > 100000) throw Error("the world is open: the robot could drive away");
    for (const auto& step : {Eigen::Vector2i{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Eigen::Vector2i next = cell + step;
      const size_t before = seen.size();
      seen.insert({next.x(), next.y(), 0});
      if (seen.size() > before) open.push_back(next);
    }
  }
  std::sort(places.begin(), places.end(), [](const Vector2d& a, const Vector2d& b) {
    return std::pair(a.y(), a.x()) < std::pair(b.y(), b.x());
  });
  return places;
}

}  // namespace

double Truth::coverage(const mapping::OccupancyMap& map) const {
  if (surface.size() == 0) return 0;
  const std::array<Vector3d, 7> around = {Vector3d{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0},
                                          {0, -1, 0},        {0, 0, 1}, {0, 0, -1}};
  size_t known = 0;
  for (const Eigen::Vector3i& cell : surface.cells()) {
    const Vector3d center = voxel * (cell.cast<double>().array() + 0.5).matrix();
    known += std::any_of(around.begin(), around.end(),
                         [&](const Vector3d& side) {
                           return map.at(center + voxel * side) == mapping::Occupancy::occupied;
                         })
                 ? 1
                 : 0;
  }
  return static_cast<double>(known) / static_cast<double>(surface.size());
}

Truth find_truth(const mapping::RayScene& scene, const Vector2d& inside, const mapping::LaserModel& laser,
                 const TruthOptions& options) {
  Truth truth;
  truth.step = options.step;
  truth.voxel = options.voxel;
  truth.places = reachable_places(scene, inside, laser.height_m + 0.05, options);
  std::vector<std::vector<Eigen::Vector3i>> hits(truth.places.size());
  parallel_for(truth.places.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f origin =
          Vector3d(truth.places[i].x(), truth.places[i].y(), laser.height_m).cast<float>();
      for (double tilt = laser.tilt_min_deg; tilt <= laser.tilt_max_deg; tilt += 1)
        for (int azimuth = 0; azimuth < 360; ++azimuth) {
          const double t = tilt * kDegree, a = azimuth * kDegree;
          const Eigen::Vector3f ray =
              Vector3d(std::cos(t) * std::cos(a), std::cos(t) * std::sin(a), std::sin(t)).cast<float>();
          const mapping::RayHit hit = scene.cast(origin, ray, static_cast<float>(options.range_max));
          if (hit.link >= 0)
            hits[i].push_back(cell_of(Eigen::Vector3f(origin + hit.distance * ray), options.voxel));
        }
    }
  });
  CellIndex cells(1 << 16);
  std::vector<int> counts;
  for (const auto& place : hits)
    for (const Eigen::Vector3i& cell : place) {
      const uint32_t number = cells.insert(cell);
      if (number == counts.size()) counts.push_back(0);
      ++counts[number];
    }
  for (size_t i = 0; i < counts.size(); ++i)
    if (counts[i] >= 2) truth.surface.insert(cells.cells()[i]);
  return truth;
}

}  // namespace loci::apps::nbv_evaluation
