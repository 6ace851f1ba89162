#include <fmt/format.h>

#include <optional>

#include "apps/evaluate/commands.h"
#include "apps/evaluate/mapping/mapper.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/sensor/pose_text.h"

namespace loci::apps {
namespace {

namespace fs = std::filesystem;

using mapping_claim::MappedWorld;
using mapping_claim::Run;

struct Arguments {
  std::vector<std::string> worlds, truths, poses, starts, package_paths;
  std::string out;
  int seeds = 3;
  bool walk = false, track = false;
  std::string floor = "auto";
  std::optional<double> ceiling;
  nbv::SurveyOptions survey;
  mapping::ComparisonOptions comparison;
};

/// The options of a survey and of the comparison in one table.
struct AllOptions {
  nbv::SurveyOptions& survey;
  mapping::ComparisonOptions& comparison;
  void declare(OptionTable& table) {
    survey.declare(table);
    comparison.declare(table);
  }
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

/// A folder as the generator of kitchens writes it.
bool is_kitchen(const fs::path& path) {
  return fs::is_regular_file(path / "kitchen.urdf") && fs::is_regular_file(path / "truth.json");
}

/// What the n-th world is mapped with, without its seed.
Run run_of(const Arguments& arguments, size_t n, Session& session) {
  const size_t worlds = arguments.worlds.size();
  Run run;
  run.world = arguments.worlds[n];
  const bool kitchen = is_kitchen(run.world);
  if (arguments.truths.empty() && fs::is_directory(run.world) && !kitchen)
    throw Error("a recording does not tell its truth", {run.world.string(), 0, ""},
                "give --truth: a URDF, a truth.json, or measured fronts");
  // A world that has a sidecar, or shapes that say enough, is its own truth.
  run.truth = !arguments.truths.empty() ? fs::path(nth(arguments.truths, n, "--truth", worlds))
              : kitchen                 ? run.world / "truth.json"
                                        : run.world;
  if (kitchen) run.world /= "kitchen.urdf";
  run.walk = arguments.walk;
  run.track = arguments.track;
  run.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
  if (!arguments.poses.empty())
    run.poses = mapping::planar_poses_from(nth(arguments.poses, n, "--poses", worlds), "--poses");
  if (!arguments.starts.empty())
    run.start = mapping::planar_poses_from(nth(arguments.starts, n, "--start", worlds), "--start").front();
  if (!fs::is_directory(run.world))
    run.floor = mapping::floor_of_world(arguments.floor, run.world, run.package_paths, session.warnings());
  run.ceiling = arguments.ceiling;
  run.threads = session.flags().threads;
  run.survey = arguments.survey;
  run.comparison = arguments.comparison;
  return run;
}

void run(const Arguments& arguments, Session& session) {
  std::optional<TemporaryFolder> temporary;
  std::vector<MappedWorld> maps;
  std::string text;
  for (size_t i = 0; i < arguments.worlds.size(); ++i) {
    Run one = run_of(arguments, i, session);
    // A recording is what it is: seeds are for simulated robots.
    for (int seed = 1; seed <= (fs::is_directory(one.world) ? 1 : arguments.seeds); ++seed) {
      one.seed = static_cast<uint64_t>(seed);
      if (arguments.out.empty()) temporary.emplace("loci_evaluate_mapping");
      const fs::path out = temporary ? temporary->path() : fs::path(arguments.out);
      one.folder = out / fmt::format("{}_{}", mapping_claim::world_name(arguments.worlds[i]), seed);
      maps.push_back(map_world(one, session.progress(), session.warnings()));
      if (session.flags().verbose)
        text += fmt::format("{}, seed {}\n{}\n", one.world.string(), seed, maps.back().last().text());
    }
  }
  session.answer(text + table_text(maps), table_json(maps));
}

}  // namespace

Command mapping_command() {
  return {
      "mapping",
      "Maps of explored kitchens against ground truth: handles, fronts, joints, supports, walls, openings",
      {"loci-evaluate mapping apps/samples/kitchen.urdf --seeds 1",
       "loci-evaluate mapping apps/samples/kitchen.urdf --truth apps/samples/kitchen.urdf --seeds 1 "
       "--poses \"1,1.5,90; 2,1.5,180; 2,1.5,-90; 3,1.5,90\" --ceiling 2.5 --json"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<Arguments>();
        table.positional(
            "WORLD...", &arguments->worlds,
            "Worlds (URDF, or a folder with kitchen.urdf and truth.json) that a simulated robot maps, or "
            "recordings with poses (--truth is needed)");
        table.option("--truth FILE", &arguments->truths, "Ground truth per world: URDF or truth.json");
        table.option("--start POSE", &arguments->starts, "Pose of the first scan per world: x,y,yaw_deg",
                     {.default_text = "the most open floor"});
        table.option("--poses POSES", &arguments->poses,
                     "Scan at these poses instead of exploring, per world: \"x,y,yaw_deg; …\"");
        table.flag("--walk", arguments->walk,
                   "Instead of a robot that explores, a person walks through with a Kinect");
        table.flag("--track", arguments->track,
                   "The poses of the walk, or of a recording, are tracked from its images; true ones "
                   "only turn and shift the map to the truth");
        table.flag("--interact", arguments->survey.interact, "Pull each handle and scan again");
        table.package_path(&arguments->package_paths);
        table.option("--seeds", &arguments->seeds, "Number of maps per world, with seeds 1, 2, …",
                     {.min = 1, .max = 1000});
        table.option("--floor HEIGHT", &arguments->floor,
                     "Height of the floor in the world's frame, where a world without a link floor gets one; "
                     "auto = its own, or 0; none = add none",
                     {.unit = "m"});
        table.option("--ceiling HEIGHT", &arguments->ceiling, "Add a ceiling at this height", {.unit = "m"});
        table.option("-o,--output FOLDER", &arguments->out, "Keep the maps in this folder");
        AllOptions options{arguments->survey, arguments->comparison};
        table.options(table_of(options), "Exploration and comparison");
        return [arguments](Session& session) { run(*arguments, session); };
      }};
}

}  // namespace loci::apps
