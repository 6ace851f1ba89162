// Scanning by next best view: explore, next-view.

#include <fmt/format.h>
#include <set>

#include "apps/map/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/occupancy_grid.h"
#include "mapping/interpretation/surfaces/levelling.h"
#include "mapping/simulation/simulated_robot.h"
#include "nbv/images.h"
#include "nbv/planner.h"
#include "nbv/survey.h"

namespace loci::apps {

namespace {

/// x, y in metres and yaw in degrees, as the command line has them.
mapping::PlanarPose planar_pose_from(const std::vector<double>& values) {
  return {values[0], values[1], values[2] * kDegree};
}

struct ExploreArguments {
  std::string world, out;
  std::vector<double> start;  ///< x, y, yaw in degrees; empty = on the most open floor
  std::vector<std::string> package_paths;
  std::string floor = "auto";
  std::optional<double> ceiling;
  bool resume = false;
  nbv::SurveyOptions options;
};

void explore(ExploreArguments& arguments, Session& session) {
  nbv::ExplorationOptions& exploration = arguments.options.exploration;
  exploration.threads = session.flags().threads;
  mapping::SimulatedRobotOptions world;
  for (const std::string& folder : arguments.package_paths) world.package_paths.emplace_back(folder);
  world.floor =
      mapping::floor_of_world(arguments.floor, arguments.world, world.package_paths, session.warnings());
  world.ceiling = arguments.ceiling;
  world.laser = exploration.laser;
  world.seed = exploration.seed;
  world.threads = exploration.threads;
  mapping::SimulatedRobot robot(arguments.world, world, {}, session.warnings());
  const mapping::PlanarPose start =
      arguments.start.empty() ? robot.open_place() : planar_pose_from(arguments.start);
  robot.put_at(start);
  if (world.floor.value_or(0) != 0) arguments.options.map_from_input = robot.map_from_world();
  const std::filesystem::path earlier = std::filesystem::path(arguments.out) / "explore.json";
  if (!arguments.resume && std::filesystem::exists(earlier))
    session.warnings().add("the earlier exploration in " + arguments.out +
                           " is replaced; --resume would go on with it");
  session.check_outputs(arguments.out,
                        {"explore.json", "map.urdf", "map.semantic.json", "report.html", "scans/scans.yaml",
                         "interaction/pulls.json", "interaction/scans.yaml"});
  const nbv::SurveyResult result = survey(robot, start, arguments.out, arguments.resume, arguments.options,
                                          session.progress(), session.warnings());
  for (const std::string& note : result.map.notes) session.warnings().add(note);
  for (const mapping::StageTime& time : result.map.times) session.timing(time.stage, time.seconds);
  session.answer(
      result.summary() + "in " + arguments.out + "/map.urdf, see " + arguments.out + "/report.html",
      result.report());
  if (!result.usable())
    throw Error(fmt::format("only {} of {} scans could be registered: the map shows a part of the room",
                            result.scans.scans.size(), result.steps.size()),
                {arguments.out, 0, {}},
                "give another --start, one from which much furniture is seen, or another --seed");
}

}  // namespace

Command explore_command() {
  return {
      "explore",
      "Explore and map an unknown kitchen by next best view",
      {"loci-map explore apps/samples/kitchen.urdf -o demo-output/kitchen",
       "loci-map explore apps/samples/kitchen.urdf --interact --seed 2 -o demo-output/kitchen_2 --json"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<ExploreArguments>();
        table.positional("WORLD", &arguments->world, "URDF of the world to scan");
        table.output("FOLDER", &arguments->out, "Folder of the map, its scans and the report",
                     {.replaces = true});
        table.package_path(&arguments->package_paths);
        table.option("--start POSE", &arguments->start,
                     "Pose of the first scan in the world frame: x,y,yaw_deg",
                     {.default_text = "the most open floor", .values = 3});
        table.option("--floor HEIGHT", &arguments->floor,
                     "Height of the floor in the world's frame, where a world without a link floor gets one; "
                     "auto = its own, or 0; none = add none",
                     {.unit = "m"});
        table.option("--ceiling HEIGHT", &arguments->ceiling, "Add a ceiling at this height", {.unit = "m"});
        table.option("--seed N", &arguments->options.exploration.seed, "Seed of noise and samples");
        table.flag("--interact", arguments->options.interact, "Pull each handle and scan again");
        table.flag("--resume", arguments->resume, "Continue an exploration that was interrupted");
        table.options(table_of(arguments->options), "Exploration");
        return [arguments](Session& session) { explore(*arguments, session); };
      }};
}

namespace {

struct NextViewArguments {
  std::string scans, pool, out;
  std::vector<double> robot;  ///< x, y, yaw in degrees; empty = at the last scan
  int seed = 1;
  mapping::OccupancyOptions occupancy;
  nbv::PlannerOptions planner;
  mapping::LaserModel laser;
};

Json pose_json(const mapping::PlanarPose& pose) {
  return {pose.x, pose.y, pose.yaw / kDegree};
}

std::string pose_text(const mapping::PlanarPose& pose) {
  return fmt::format("x {:.2f} m, y {:.2f} m, yaw {:.0f}°", pose.x, pose.y, pose.yaw / kDegree);
}

/// Moves scans so that their floor lies at z = 0; x, y and yaw stay.
void level(mapping::ScanSet& set, const std::string& path, Session& session) {
  NoProgress quiet;
  const mapping::Surface surface = gather_surface(set, session.flags().threads, quiet);
  std::optional<Isometry3d> levelled;
  for (const Vector3d& up : up_hints(set))
    if (!levelled) levelled = level_by_floor(surface, up);
  if (!levelled)
    throw Error("the scans are not levelled, and no floor was found in them", {path, 0, {}},
                "level them so that the floor is at z = 0 and set 'levelled: true'");
  for (mapping::Scan& scan : set.scans) scan.map_from_scan = *levelled * scan.map_from_scan;
  set.levelled = true;
  session.warnings().add("the scans were levelled by their floor; x, y and yaw are theirs", {path, 0, {}});
}

mapping::ScanSet read_scans(const std::string& path, const std::string& what, Session& session) {
  mapping::ScanSet set = mapping::read_registered_scans(path, session.warnings());
  if (!set.free_space)
    throw Error("without scan origins nothing is known to be free", {path, 0, {}},
                what + " is a folder with scans.yaml, poses and origins");
  if (!set.levelled) level(set, path, session);
  return set;
}

Json view_json(const nbv::NextView& view) {
  Json json;
  json["pose"] = view.pose ? pose_json(*view.pose) : Json();
  json["reason"] = view.reason;
  json["expected_overlap"] = view.expected_overlap;
  json["expected_gain_m2"] = view.expected_gain;
  json["frontier_voxels"] = view.frontier_voxels;
  json["path"] = Json::array();
  for (const mapping::PlanarPose& corner : view.path) json["path"].push_back(pose_json(corner));
  json["details"] = view.details;
  return json;
}

std::string view_text(const nbv::NextView& view) {
  if (!view.pose) return "Stop: " + view.reason;
  std::string text = fmt::format("Scan at {}: {}", pose_text(*view.pose), view.reason);
  if (!view.path.empty()) {
    text += "\npath:";
    for (const mapping::PlanarPose& corner : view.path)
      text += fmt::format(" ({:.2f}, {:.2f})", corner.x, corner.y);
  }
  return text;
}

/// The scans of the pool that are not in the map yet, by name.
void choose(const NextViewArguments& arguments, const mapping::ScanSet& scans, const mapping::ScanSet& pool,
            const mapping::OccupancyMap& map, Session& session) {
  std::set<std::string> taken;
  for (const mapping::Scan& scan : scans.scans) taken.insert(scan.name);
  std::vector<mapping::PlanarPose> poses;
  std::vector<std::string> names;
  for (const mapping::Scan& scan : pool.scans) {
    if (taken.contains(scan.name)) continue;
    poses.push_back(mapping::planar(scan.map_from_scan));
    names.push_back(scan.name);
  }
  const nbv::PoolChoice choice = choose_view(map, poses, arguments.laser, arguments.planner);
  Json json = view_json(choice.view);
  json["scan"] = choice.index ? Json(names[*choice.index]) : Json();
  session.answer((choice.index ? names[*choice.index] + ". " : "") + view_text(choice.view), json);
}

void next(NextViewArguments& arguments, Session& session) {
  table_of(arguments.occupancy).validate();
  table_of(arguments.planner).validate();
  arguments.planner.threads = arguments.occupancy.threads = session.flags().threads;
  const mapping::ScanSet scans = read_scans(arguments.scans, "a scan set", session);
  std::optional<mapping::ScanSet> pool;
  if (!arguments.pool.empty()) pool = read_scans(arguments.pool, "a pool", session);
  mapping::OccupancyMap map(arguments.occupancy);
  Stopwatch watch;
  for (size_t i = 0; i < scans.scans.size(); ++i) {
    session.progress().check(static_cast<double>(i) / static_cast<double>(scans.scans.size()), "inserting");
    map.insert(scans.scans[i]);
  }
  session.timing("insertion", watch.lap());
  if (pool) return choose(arguments, scans, *pool, map, session);

  const mapping::PlanarPose robot = arguments.robot.empty()
                                        ? mapping::planar(scans.scans.back().map_from_scan)
                                        : planar_pose_from(arguments.robot);
  const nbv::ViewPlan plan = plan_view(map, robot, arguments.laser, arguments.planner,
                                       Random(static_cast<uint64_t>(arguments.seed)));
  session.timing("decision", watch.lap());
  Json json = view_json(plan.view);
  json["robot"] = pose_json(robot);
  if (!arguments.out.empty()) {
    session.check_outputs(arguments.out, {"map.bt", "floor.pgm", "floor.yaml"});
    for (const auto& file : write_view_images(plan, robot, arguments.out))
      json["images"].push_back(file.string());
    map.write_bt(std::filesystem::path(arguments.out) / "map.bt");
    const mapping::OccupancyGrid grid = occupancy_grid(map.tree(), mapping::GridOptions{});
    write_file_atomically(std::filesystem::path(arguments.out) / "floor.pgm", pgm_text(grid));
    write_file_atomically(std::filesystem::path(arguments.out) / "floor.yaml", grid_yaml(grid, "floor.pgm"));
  }
  session.answer(view_text(plan.view), json);
}

}  // namespace

Command next_view_command() {
  return {"next-view",
          "Plan the next best view for a set of scans",
          {"loci-map next-view demo-output/scans --robot-pose 2.2,1.2,0",
           "loci-map next-view demo-output/scans --robot-pose 2.2,1.2,0 -o demo-output/next-view --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<NextViewArguments>();
            table.positional("SCANS", &arguments->scans, "Folder of posed scans (registered, levelled)");
            table.option("--robot-pose POSE", &arguments->robot, "Pose of the robot: x,y,yaw_deg",
                         {.default_text = "at the last scan", .values = 3});
            table.option("--pool SCANS", &arguments->pool,
                         "Choose among the posed scans in this folder that SCANS does not have");
            table.option("-o,--output FOLDER", &arguments->out,
                         "Folder for images of the costmaps, map.bt and floor.pgm", {.replaces = true});
            table.option("--seed N", &arguments->seed, "Seed of the samples", {.min = 0, .max = 1 << 30});
            table.options(table_of(arguments->occupancy), "Occupancy map");
            table.options(table_of(arguments->planner), "Planner");
            table.option("--height-m HEIGHT", &arguments->laser.height_m,
                         "Height of the scanner over the floor", {.unit = "m", .min = 0.05, .max = 5.0});
            return [arguments](Session& session) { next(*arguments, session); };
          }};
}

}  // namespace loci::apps
