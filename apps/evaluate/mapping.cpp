#include "apps/evaluate/mapping/mapper.h"

#include "apps/evaluate/commands.h"
#include "mapping/sensor/pose_text.h"

namespace loci {
namespace {

using mapping_claim::MappedWorld;
using mapping_claim::Run;

struct Arguments {
  std::vector<std::string> worlds, truths, poses, package_paths;
  int seeds = 3;
  std::optional<double> ceiling;
  ComparisonOptions comparison;
};

/// The value for the n-th world: one for all, or one for each.
const std::string& nth(const std::vector<std::string>& values, size_t n, const std::string& what,
                       size_t worlds) {
  if (values.size() != 1 && values.size() != worlds)
    throw Error(what + " is given " + std::to_string(values.size()) + " times for " + std::to_string(worlds) +
                    " worlds",
                {}, "give it once for each");
  return values.size() == 1 ? values.front() : values[n];
}

void run(const Arguments& arguments, Session& session) {
  std::vector<MappedWorld> maps;
  std::string text;
  const size_t worlds = arguments.worlds.size();
  for (size_t i = 0; i < worlds; ++i)
    for (int seed = 1; seed <= arguments.seeds; ++seed) {
      Run one;
      one.world = arguments.worlds[i];
      // A world that has a sidecar, or shapes that say enough, is its own truth.
      one.truth =
          arguments.truths.empty() ? arguments.worlds[i] : nth(arguments.truths, i, "--truth", worlds);
      one.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
      one.poses = planar_poses_from(nth(arguments.poses, i, "--poses", worlds), "--poses");
      one.ceiling = arguments.ceiling;
      one.seed = static_cast<uint64_t>(seed);
      one.threads = session.flags().threads;
      one.comparison = arguments.comparison;
      maps.push_back(map_world(one, session.progress(), session.warnings()));
      if (session.flags().verbose)
        text += one.world.string() + ", seed " + std::to_string(seed) + "\n" + maps.back().comparison.text() +
                "\n";
    }
  session.answer(text + table_text(maps), table_json(maps));
}

}  // namespace

Command mapping_command() {
  return {
      "mapping",
      "Maps of worlds against the truth: handles, fronts, joints, supports, walls",
      {"loci-evaluate mapping apps/samples/kitchen.urdf --seeds 1 --poses \"1,1.5,90; 2,1.5,90; 3,1.5,90; "
       "2,1.5,-90\"",
       "loci-evaluate mapping apps/samples/kitchen.urdf --truth apps/samples/kitchen.urdf --seeds 1 --poses "
       "\"1,1.5,90; 2,1.5,180; 2,1.5,-90; 3,1.5,90\" --ceiling 2.5 --json"},
      [](CLI::App& app) {
        auto arguments = std::make_shared<Arguments>();
        app.add_option("WORLDS", arguments->worlds, "Worlds (URDF) to map")->required();
        app.add_option("--truth", arguments->truths,
                       "Per world: URDF or truth.json; without, the world itself")
            ->allow_extra_args(false);
        app.add_option("--poses", arguments->poses,
                       "Per world: where to scan from, \"x,y,yaw_deg; …\", metres, in the world's frame")
            ->allow_extra_args(false)
            ->required();
        app.add_option("--package-path", arguments->package_paths, "Folder for package:// names; may repeat")
            ->allow_extra_args(false);
        app.add_option("--seeds", arguments->seeds, "Each world is mapped so often, with seeds 1, 2, …")
            ->check(CLI::Range(1, 1000));
        app.add_option("--ceiling", arguments->ceiling, "Height of a ceiling to add [m]");
        add_options(app, table_of(arguments->comparison));
        return [arguments](Session& session) { run(*arguments, session); };
      }};
}

}  // namespace loci
