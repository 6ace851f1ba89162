#include "apps/evaluate/nbv/exploration.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/math/math.h"

namespace loci::apps::nbv_evaluation {
namespace {

/// Starts: random reachable places, looking where there is most room.
std::vector<mapping::PlanarPose> starts_of(const Truth& truth, const mapping::RayScene& scene,
                                           const ExplorationOptions& options) {
  std::vector<mapping::PlanarPose> starts;
  Random random(static_cast<uint64_t>(options.seed));
  for (int i = 0; i < options.starts; ++i) {
    const Vector2d place = truth.places[random.index(truth.places.size())];
    mapping::PlanarPose start{place.x(), place.y(), 0};
    double most = 0;
    for (int direction = 0; direction < 8; ++direction) {
      const double yaw = kPi / 4 * direction;
      const Eigen::Vector3f ray(static_cast<float>(std::cos(yaw)), static_cast<float>(std::sin(yaw)), 0);
      const double room =
          std::min(10.F, scene.cast(Vector3d(place.x(), place.y(), 0.5).cast<float>(), ray, 10).distance);
      if (room > most) {
        most = room;
        start.yaw = yaw;
      }
    }
    starts.push_back(start);
  }
  return starts;
}

Run run_of(const NamedStrategy& strategy, const mapping::PlanarPose& start, const Truth& truth,
           const mapping::RayScene& scene, const mapping::LaserModel& laser,
           const ExplorationOptions& options, uint64_t seed, Progress& progress) {
  Run run;
  run.strategy = strategy.name;
  run.start = start;
  Random random(seed);
  mapping::OccupancyMap map(options.occupancy);
  mapping::PlanarPose robot = start;
  while (true) {
    progress.check(static_cast<double>(run.coverage.size()) / options.max_scans,
                   fmt::format("{}: {:.1f} % known", strategy.name,
                               run.coverage.empty() ? 0 : 100 * run.coverage.back()));
    Isometry3d scanner = map_from_base(robot);
    scanner.translation().z() = laser.height_m;
    map.insert(simulate_sweep(scene, scanner, laser, random.fork(run.coverage.size()), options.threads));
    run.coverage.push_back(truth.coverage(map));
    if (static_cast<int>(run.coverage.size()) == options.max_scans) return run;
    const Decision decision = strategy.decide(map, robot, random);
    run.seconds.push_back(decision.seconds);
    run.cpu_seconds.push_back(decision.cpu_seconds);
    run.cut = run.cut || decision.cut;
    if (!decision.pose) break;
    run.overlap.push_back(decision.overlap);
    robot = *decision.pose;
  }
  run.stopped = true;
  return run;
}

}  // namespace

void ExplorationOptions::declare(OptionTable& table) {
  table.integer("starts", starts, "", "Random starts per world.", 1, 100);
  table.integer("seed", seed, "", "Seed of starts and noise.", 0, 1 << 30);
  table.integer("max_scans", max_scans, "", "Scans of an exploration.", 1, 200);
  table.number("exhaustive_s", exhaustive_s, "s", "Longest decision of the exhaustive planner.", 0.1, 1e5);
  table.number("goal", goal, "", "Coverage to reach.", 0.01, 1);
  planner.declare(table);
  occupancy.declare(table);
}

int Run::scans_to(double goal) const {
  for (size_t i = 0; i < coverage.size(); ++i)
    if (coverage[i] >= goal) return static_cast<int>(i) + 1;
  return 0;
}

WorldResult explore(const std::filesystem::path& urdf,
                    const std::vector<std::filesystem::path>& package_paths,
                    const ExplorationOptions& options, Progress& progress, Warnings& warnings) {
  mapping::SimulatedRobotOptions world_options;
  world_options.package_paths = package_paths;
  world_options.threads = options.threads;
  world_options.ceiling = options.ceiling;
  const mapping::SimulatedRobot world(urdf, world_options, {}, warnings);
  const mapping::PlanarPose inside = world.open_place();
  TruthOptions truth_options;
  truth_options.robot_radius = options.planner.robot_radius_m;
  truth_options.voxel = options.occupancy.resolution_m;
  truth_options.range_max = options.occupancy.range_max_m;
  truth_options.threads = options.threads;
  progress.check(0, "truth");
  const Truth truth = find_truth(world.scene(), {inside.x, inside.y}, world_options.laser, truth_options);
  WorldResult result;
  result.world = urdf.stem().string();
  result.places = truth.places.size();
  result.surface = truth.surface.size();
  const std::vector<mapping::PlanarPose> starts = starts_of(truth, world.scene(), options);
  std::vector<NamedStrategy> all = strategies(world_options.laser, options.planner, options.exhaustive_s);
  std::erase_if(all, [&](const NamedStrategy& strategy) {
    return std::find(options.planners.begin(), options.planners.end(), strategy.name) ==
           options.planners.end();
  });
  const double total = static_cast<double>(starts.size() * all.size());
  for (size_t i = 0; i < starts.size(); ++i)
    for (const NamedStrategy& strategy : all) {
      const double done = static_cast<double>(result.runs.size());
      PartialProgress part(progress, done / total, (done + 1) / total);
      result.runs.push_back(run_of(strategy, starts[i], truth, world.scene(), world_options.laser, options,
                                   static_cast<uint64_t>(options.seed) * 1000 + i, part));
    }
  return result;
}

}  // namespace loci::apps::nbv_evaluation
