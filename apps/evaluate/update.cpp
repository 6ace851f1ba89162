#include "apps/evaluate/commands.h"
#include "apps/evaluate/update/experiment.h"
#include "apps/evaluate/update/perceived.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> worlds, package_paths;
  std::string out, sensor = "laser";
  bool perceive = false;
  update_claim::Settings settings;
};

void run(Arguments& arguments, Session& session) {
  update_claim::Settings& settings = arguments.settings;
  settings.threads = session.flags().threads;
  settings.kinect = arguments.sensor == "kinect";
  settings.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
  std::optional<TemporaryFolder> temporary;
  if (arguments.out.empty()) temporary.emplace("loci-evaluate-update");
  settings.folder = temporary ? temporary->path() : std::filesystem::path(arguments.out);
  if (arguments.perceive) {
    settings.keep = !temporary;  // Recordings and memories are large.
    std::vector<update_claim::PerceivedTrial> trials;
    for (const std::string& world : arguments.worlds)
      for (update_claim::PerceivedTrial& trial :
           perceive_world(world, settings, session.progress(), session.warnings()))
        trials.push_back(std::move(trial));
    session.answer(perceived_text(trials, session.flags().verbose), perceived_json(trials));
    return;
  }
  std::vector<update_claim::Trial> trials;
  for (const std::string& world : arguments.worlds)
    for (update_claim::Trial& trial : run_world(world, settings, session.progress(), session.warnings()))
      trials.push_back(std::move(trial));
  session.answer(table_text(trials, session.flags().verbose), table_json(trials));
}

}  // namespace

Command update_command() {
  return {
      "update",
      "Map updates after furniture was moved: moves found, pose errors, false changes",
      {"loci-evaluate update apps/samples/kitchen.urdf --trials 1 -o demo-output/moves",
       "loci-evaluate update apps/samples/kitchen.urdf --trials 1 --part -o demo-output/moves --json",
       "loci-evaluate update apps/samples/kitchen.urdf --trials 1 --perceive"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<Arguments>();
        update_claim::Settings& settings = arguments->settings;
        table.positional("WORLD...", &arguments->worlds,
                         "Worlds (URDF) that are explored, changed and scanned again");
        table.option("--movable PREFIX", &settings.families,
                     "Beginnings of the names of links that are moved");
        table.option("--trials", &settings.trials, "Changes of furniture per world", {.min = 1, .max = 1000});
        table.option("--moves", &settings.moves, "Most pieces that are moved at once", {.min = 1, .max = 20});
        table.option("--sensor SENSOR", &arguments->sensor, "What sees the changed room",
                     {.choices = {"laser", "kinect"}});
        table.flag(
            "--perceive", arguments->perceive,
            "Perceive the changed room with the map of before, instead: what is said of its furniture and "
            "of objects on it");
        table.flag("--part", settings.part, "See only a part of the room: two views");
        table.option("--seed", &settings.seed, "Seed of moves and noise", {.min = 0, .max = 1000000});
        table.package_path(&arguments->package_paths);
        table.option("-o,--output FOLDER", &arguments->out,
                     "Keep the maps in this folder; those in it are used again");
        return [arguments](Session& session) { run(*arguments, session); };
      }};
}

}  // namespace loci::apps
