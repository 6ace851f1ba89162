#include "apps/evaluate/nbv/strategies.h"

#include <cmath>
#include <mutex>

#include "mapping/base/math/math.h"
#include "mapping/base/math/shuffle.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"

namespace loci::apps::nbv_evaluation {
namespace {

/// States in a decision what it took since `watch` was made.
void state_times(const Stopwatch& watch, Decision& decision) {
  decision.seconds = watch.seconds();
  decision.cpu_seconds = watch.cpu_seconds();
}

/// What the peers see of a map: the same as our planner.
struct Surroundings {
  mapping::Voxels voxels;
  mapping::FloorGrid floor;
  nbv::Reachability reach;
  std::vector<size_t> standing;

  Surroundings(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
               const mapping::LaserModel& laser, const nbv::PlannerOptions& options) {
    voxels = map.voxels();
    floor = drivable_floor(voxels, robot, laser, options);
    reach = reachability(floor, robot, options);
    for (size_t cell = 0; cell < floor.cells(); ++cell)
      if (reach.stands(floor, cell)) standing.push_back(cell);
  }
  Vector2d center(size_t cell) const {
    const auto width = static_cast<size_t>(floor.width);
    return floor.center(static_cast<int>(cell % width), static_cast<int>(cell / width));
  }
};

Decision ours(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
              const mapping::LaserModel& laser, const nbv::PlannerOptions& options, Random& random) {
  Decision decision;
  const Stopwatch watch;
  const nbv::NextView view = next_view(map, robot, laser, options, random.fork(random.bits()));
  state_times(watch, decision);
  decision.pose = view.pose;
  decision.overlap = view.expected_overlap;
  return decision;
}

Decision random_pose(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                     const mapping::LaserModel& laser, const nbv::PlannerOptions& options, Random& random) {
  Decision decision;
  const Stopwatch watch;
  const Surroundings around(map, robot, laser, options);
  if (!around.standing.empty()) {
    const Vector2d place = around.center(around.standing[random.index(around.standing.size())]);
    decision.pose = mapping::PlanarPose{place.x(), place.y(), random.uniform(-kPi, kPi)};
  }
  state_times(watch, decision);
  return decision;
}

/// Frontier cells, free floor beside floor that is not known, in connected groups (eight neighbours).
std::vector<std::vector<size_t>> frontiers(const mapping::FloorGrid& floor) {
  const auto is_frontier = [&](int x, int y) {
    const size_t at = floor.index(x, y);
    if (floor.seen[at] == 0 || floor.obstacle[at] != 0) return false;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!floor.contains(x + dx, y + dy)) return true;
      const size_t next = floor.index(x + dx, y + dy);
      if (floor.seen[next] == 0 && floor.obstacle[next] == 0) return true;
    }
    return false;
  };
  std::vector<uint8_t> todo(floor.cells(), 0);
  for (int y = 0; y < floor.height; ++y)
    for (int x = 0; x < floor.width; ++x) todo[floor.index(x, y)] = is_frontier(x, y) ? 1 : 0;
  std::vector<std::vector<size_t>> groups;
  for (size_t seed = 0; seed < todo.size(); ++seed) {
    if (todo[seed] == 0) continue;
    std::vector<size_t> group{seed};
    todo[seed] = 0;
    for (size_t i = 0; i < group.size(); ++i) {
      const int x = static_cast<int>(group[i] % static_cast<size_t>(floor.width));
      const int y = static_cast<int>(group[i] / static_cast<size_t>(floor.width));
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (!floor.contains(x + dx, y + dy) || todo[floor.index(x + dx, y + dy)] == 0) continue;
          todo[floor.index(x + dx, y + dy)] = 0;
          group.push_back(floor.index(x + dx, y + dy));
        }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Goes to the nearest frontier that is as long as the robot is wide: to the reachable place nearest to its
/// middle, looking at it. A frontier that the robot stands beside already shows nothing new, it is left out.
Decision nearest_frontier(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                          const mapping::LaserModel& laser, const nbv::PlannerOptions& options, Random&) {
  Decision decision;
  const Stopwatch watch;
  const Surroundings around(map, robot, laser, options);
  float nearest = nbv::Reachability::kUnreachable;
  for (const auto& group : frontiers(around.floor)) {
    if (static_cast<double>(group.size()) * around.floor.cell < 2 * options.robot_radius_m) continue;
    Vector2d middle = Vector2d::Zero();
    for (const size_t cell : group) middle += around.center(cell);
    middle /= static_cast<double>(group.size());
    double closest = 1;  // A frontier farther than this from any reachable place is out of reach, metres.
    size_t place = around.floor.cells();
    for (const size_t cell : around.standing)
      if (const double distance = (around.center(cell) - middle).norm(); distance < closest) {
        closest = distance;
        place = cell;
      }
    if (place == around.floor.cells() || around.reach.distance[place] >= nearest ||
        around.reach.distance[place] < 0.2F)
      continue;
    nearest = around.reach.distance[place];
    const Vector2d at = around.center(place), look = middle - at;
    decision.pose =
        mapping::PlanarPose{at.x(), at.y(), look.norm() > 1e-6 ? std::atan2(look.y(), look.x()) : robot.yaw};
  }
  state_times(watch, decision);
  return decision;
}

Decision exhaustive(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                    const mapping::LaserModel& laser, const nbv::PlannerOptions& options, double limit,
                    Random& random) {
  Decision decision;
  const Stopwatch watch;
  const Surroundings around(map, robot, laser, options);
  const nbv::ViewVoxels frontier = nbv::find_frontier(around.voxels, options.threads);
  const nbv::ViewCaster caster(around.voxels, frontier, laser, options.max_distance_m, options.ray_step_deg);
  std::vector<size_t> places = around.standing;
  shuffle(places, random);
  std::mutex mutex;
  nbv::ViewCounts best;
  size_t looked_at = 0;
  Decision prepared;
  state_times(watch, prepared);
  parallel_for(places.size(), options.threads, [&](size_t from, size_t to) {
    for (size_t i = from; i < to && watch.seconds() < limit; ++i) {
      const Vector2d place = around.center(places[i]);
      const std::vector<nbv::ViewCounts> panorama = caster.panorama(place);
      const std::lock_guard lock(mutex);
      ++looked_at;
      for (int k = 0; k < options.orientations; ++k) {
        const double yaw = std::remainder(2 * kPi * k / options.orientations, 2 * kPi);
        const nbv::ViewCounts counts = caster.part(panorama, yaw);
        if (counts.frontier < options.min_gain || counts.frontier <= best.frontier) continue;
        best = counts;
        decision.pose = mapping::PlanarPose{place.x(), place.y(), yaw};
        decision.overlap = counts.overlap();
      }
    }
  });
  state_times(watch, decision);
  decision.cut = looked_at < places.size();
  const double share =
      static_cast<double>(places.size()) / static_cast<double>(std::max<size_t>(looked_at, 1));
  decision.seconds = prepared.seconds + (decision.seconds - prepared.seconds) * share;
  decision.cpu_seconds = prepared.cpu_seconds + (decision.cpu_seconds - prepared.cpu_seconds) * share;
  return decision;
}

}  // namespace

std::vector<std::string> planner_names() {
  std::vector<std::string> names;
  for (const NamedStrategy& strategy : strategies({}, {}, 0)) names.push_back(strategy.name);
  return names;
}

std::vector<NamedStrategy> strategies(const mapping::LaserModel& laser, const nbv::PlannerOptions& options,
                                      double exhaustive_s) {
  const auto named = [&](std::string name, auto decide) {
    return NamedStrategy{
        std::move(name),
        [laser, options, decide](const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                                 Random& random) { return decide(map, robot, laser, options, random); }};
  };
  return {named("ours", ours),
          named("random", random_pose),
          named("frontier", nearest_frontier),
          {"exhaustive", [laser, options, exhaustive_s](const mapping::OccupancyMap& map,
                                                        const mapping::PlanarPose& robot, Random& random) {
             return exhaustive(map, robot, laser, options, exhaustive_s, random);
           }}};
}

}  // namespace loci::apps::nbv_evaluation
