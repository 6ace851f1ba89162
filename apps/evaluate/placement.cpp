#include "apps/evaluate/commands.h"
#include "apps/evaluate/placement/experiment.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> worlds, package_paths;
  std::string out;
  bool known_motion = false;
  placement_claim::Settings settings;
};

void run(Arguments& arguments, Session& session) {
  placement_claim::Settings& settings = arguments.settings;
  settings.threads = session.flags().threads;
  settings.tracked = !arguments.known_motion;
  settings.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
  std::optional<TemporaryFolder> temporary;
  if (arguments.out.empty()) temporary.emplace("loci-evaluate-placement");
  settings.folder = temporary ? temporary->path() : std::filesystem::path(arguments.out);
  const std::vector<std::filesystem::path> worlds(arguments.worlds.begin(), arguments.worlds.end());
  const auto trials = place_visits(worlds, settings, session.progress(), session.warnings());
  session.answer(table_text(trials, session.flags().verbose), table_json(trials));
}

}  // namespace

Command placement_command() {
  return {"placement",
          "Recordings without poses in maps of their own room and of others: placed right, wrong or refused",
          {"loci-evaluate placement apps/samples/kitchen.urdf --places 1 --known-motion",
           "loci-evaluate placement apps/samples/kitchen.urdf --places 1 --known-motion --stretched --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            placement_claim::Settings& settings = arguments->settings;
            table.positional("WORLD...", &arguments->worlds,
                             "Worlds (URDF) that are mapped and visited again");
            table.option("--visits", &settings.visits, "Visits per world", {.min = 1, .max = 1000});
            table.option("--places", &settings.places, "Places of a visit where the person turns round",
                         {.min = 1, .max = 1000});
            table.flag("--stretched", settings.stretched,
                       "Also rooms that are 1, 2, 4 and 8 % longer and wider than the map's");
            table.flag("--known-motion", arguments->known_motion,
                       "The motion of the camera is known, and not tracked");
            table.option("--seed", &settings.seed, "Seed of paths and noise", {.min = 0, .max = 1000000});
            table.package_path(&arguments->package_paths);
            table.option("-o,--output FOLDER", &arguments->out,
                         "Keep the recordings in this folder; those in it are used again");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
