#include <fmt/format.h>

#include "apps/map/commands.h"
#include "mapping/base/json.h"
#include "mapping/sensor/pose_text.h"
#include "mapping/simulation/simulated_robot.h"
#include "nbv/survey.h"

namespace loci::apps {
namespace {

struct ExploreArguments {
  std::string world, out, start, scanner = "hokuyo";
  std::vector<std::string> package_paths;
  double floor = 0;
  std::optional<double> ceiling;
  bool resume = false;
  nbv::SurveyOptions options;
};

void explore(ExploreArguments& arguments, Session& session) {
  nbv::ExplorationOptions& exploration = arguments.options.exploration;
  exploration.threads = session.flags().threads;
  mapping::SimulatedRobotOptions world;
  for (const std::string& folder : arguments.package_paths) world.package_paths.emplace_back(folder);
  world.floor = arguments.floor;
  world.ceiling = arguments.ceiling;
  world.laser = exploration.laser;
  world.seed = exploration.seed;
  world.threads = exploration.threads;
  mapping::SimulatedRobot robot(arguments.world, world, {}, session.warnings());
  const mapping::PlanarPose start = arguments.start.empty()
                                        ? robot.open_place()
                                        : mapping::planar_poses_from(arguments.start, "--start").front();
  robot.put_at(start);
  const nbv::SurveyResult result = survey(robot, start, arguments.out, arguments.resume, arguments.options,
                                          session.progress(), session.warnings());
  for (const std::string& note : result.map.notes) session.warnings().add(note);
  for (const mapping::StageTime& time : result.map.times) session.timing(time.stage, time.seconds);
  session.answer(
      result.summary() + "in " + arguments.out + "/map.urdf, see " + arguments.out + "/report.html",
      result.report());
}

}  // namespace

Command explore_command() {
  return {"explore",
          "Scans an unknown kitchen by next best view and maps it",
          {"loci-map explore apps/samples/kitchen.urdf -o demo-output/kitchen",
           "loci-map explore apps/samples/kitchen.urdf --interact --seed 2 -o demo-output/kitchen_2 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<ExploreArguments>();
            table.positional("WORLD", &arguments->world, "URDF of the world that is scanned");
            table.option("-o,--output", &arguments->out, "Folder of the map, its scans and the report",
                         {.required = true});
            table.option("--package-path", &arguments->package_paths,
                         "Folder that holds packages (package://NAME/…); can be given several times");
            table.option("--start", &arguments->start, "First scan: x,y,yaw_deg in the world's frame",
                         {.default_text = "the most open floor"});
            table.option("--scanner", &arguments->scanner, "Sensor", {.choices = {"hokuyo"}});
            table.option("--floor", &arguments->floor, "Height of the floor that is added to the world",
                         {.unit = "m"});
            table.option("--ceiling", &arguments->ceiling, "Height of a ceiling to add", {.unit = "m"});
            table.option("--seed", &arguments->options.exploration.seed, "Seed of noise and samples");
            table.flag("--interact", arguments->options.interact, "Pull each handle and scan again");
            table.flag("--resume", arguments->resume, "Go on with an exploration that was interrupted");
            table.options(table_of(arguments->options));
            return [arguments](Session& session) { explore(*arguments, session); };
          }};
}

}  // namespace loci::apps
