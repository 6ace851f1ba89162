#include <fmt/format.h>

#include <sstream>

#include "apps/simulate/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/sensor/pose_text.h"
#include "mapping/simulation/simulated_robot.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string world, out, poses;
  std::string floor = "auto";
  std::optional<double> ceiling;
  std::vector<std::string> joints;
  std::vector<std::filesystem::path> package_paths;
  bool odometry = false;
  int seed = 1;
  mapping::LaserModel laser;
  mapping::OdometryModel drift;

  void declare(OptionTable& table) {
    table.flag("odometry", odometry, "Poses drift as a wheeled robot's do, and have covariances.");
    table.integer("seed", seed, "", "Seed of noise and drift; the same seed gives the same bytes.", 0,
                  1 << 30);
    laser.declare(table);
    drift.declare(table);
  }
};

double number_from(const std::string& text, const std::string& what) {
  std::istringstream stream(text);
  double value = 0;
  if (!(stream >> value) || !(stream >> std::ws).eof())
    throw Error(fmt::format("{}: '{}' is not a number", what, text));
  return value;
}

JointState joints_from(const std::vector<std::string>& texts) {
  JointState state;
  for (const std::string& text : texts) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(fmt::format("--joints: '{}' is not joint=value", text));
    state[text.substr(0, equals)] = number_from(text.substr(equals + 1), "--joints");
  }
  return state;
}

Json scan_report(const mapping::Scan& scan) {
  size_t returned = 0;
  for (const mapping::ScanPoint& point : scan.points) returned += point.returned ? 1 : 0;
  return {{"name", scan.name},
          {"pose", values_from_pose(scan.map_from_scan)},
          {"rays", scan.points.size()},
          {"returns", returned}};
}

/// A line of truth.jsonl, which only evaluation reads.
std::string truth_line(const std::string& name, const mapping::SimulatedRobot& robot) {
  const Json line = {
      {"scan", name}, {"pose", values_from_pose(robot.true_map_from_scanner())}, {"joints", robot.joints()}};
  return line.dump();
}

void scan(Arguments& arguments, Session& session) {
  table_of(arguments).validate();
  const std::vector<mapping::PlanarPose> poses = mapping::planar_poses_from(arguments.poses, "--poses");
  mapping::SimulatedRobotOptions options;
  options.package_paths = arguments.package_paths;
  options.floor =
      mapping::floor_of_world(arguments.floor, arguments.world, options.package_paths, session.warnings());
  options.ceiling = arguments.ceiling;
  options.laser = arguments.laser;
  options.odometry = arguments.odometry ? arguments.drift : mapping::OdometryModel{0, 0, 0};
  options.seed = static_cast<uint64_t>(arguments.seed);
  options.threads = session.flags().threads;
  mapping::SimulatedRobot robot(arguments.world, options, poses.front(), session.warnings());
  robot.set_joints(joints_from(arguments.joints));

  session.check_outputs(arguments.out, {"scans.yaml", "truth.jsonl"});
  mapping::ScanSet set;
  std::string truth;
  set.sensor = mapping::kLaserSensor;
  set.range_max = options.laser.range_max_m;
  Json reports = Json::array();
  const Stopwatch watch;
  for (const mapping::PlanarPose& pose : poses) {
    session.progress().check(static_cast<double>(set.scans.size()) / static_cast<double>(poses.size()),
                             "scanning");
    set.scans.push_back(robot.scan_at(pose));
    reports.push_back(scan_report(set.scans.back()));
    truth += truth_line(set.scans.back().name, robot) + "\n";
  }
  session.timing("sweeps", watch.seconds());
  for (const mapping::Scan& scan : set.scans) session.check_outputs(arguments.out, {scan.name + ".pcd"});
  write_scan_set(set, arguments.out);
  write_file_atomically(std::filesystem::path(arguments.out) / "truth.jsonl", truth);
  session.answer(fmt::format("{}: {} scans", arguments.out, set.scans.size()),
                 {{"folder", arguments.out}, {"scans", reports}});
}

}  // namespace

Command scan_command() {
  return {
      "scan",
      "Scan a world with a simulated tilting laser",
      {"loci-simulate scan apps/samples/kitchen.urdf --poses \"1.5,1.5,0; 2.5,1.5,180\" -o demo-output/laser",
       "loci-simulate scan apps/samples/kitchen.urdf --poses \"1.5,1.5,90\" --joints "
       "drawer_1_front_joint=0.3 --odometry --seed 7 -o demo-output/laser_open"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<Arguments>();
        table.positional("WORLD", &arguments->world, "URDF of the world to scan");
        table.option("--poses POSES", &arguments->poses,
                     "Poses of the robot in the world frame: \"x,y,yaw_deg; x,y,yaw_deg; …\"",
                     {.required = true});
        table.output("FOLDER", &arguments->out, "Folder of the scan set", {.replaces = true});
        table.package_path(&arguments->package_paths);
        table.option("--floor HEIGHT", &arguments->floor,
                     "Height of the floor in the world's frame, where a world without a link floor gets one; "
                     "auto = its own, or 0; none = add none",
                     {.unit = "m"});
        table.option("--ceiling HEIGHT", &arguments->ceiling, "Add a ceiling at this height", {.unit = "m"});
        table.option("--joints JOINT=VALUE...", &arguments->joints, "Positions of joints",
                     {.unit = "m or rad", .open_end = true});
        table.options(table_of(*arguments), "Sensor and odometry");
        return [arguments](Session& session) { scan(*arguments, session); };
      }};
}

}  // namespace loci::apps
