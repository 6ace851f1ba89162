#include <fmt/format.h>

#include <optional>

#include "apps/evaluate/changes/answers.h"
#include "apps/evaluate/changes/comparison.h"
#include "apps/evaluate/changes/mistakes.h"
#include "apps/evaluate/changes/random_day.h"
#include "apps/evaluate/changes/remember.h"
#include "apps/evaluate/changes/teaching.h"
#include "apps/evaluate/changes/truth.h"
#include "apps/evaluate/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "mapping/simulation/record.h"

namespace loci::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  int runs = 2, scenes = changes::kScenesOfADay;
  uint64_t seed = 1;
  std::vector<std::string> worlds, package_paths;
  std::string samples = "apps/samples", map, keep;
  std::string diagrams, mistakes;
  bool drawers = false, teach = false;
};

/// What is measured of a day.
struct DayResult {
  std::vector<changes::Comparison> methods;
  changes::AnswerScore answers;
  std::vector<changes::Mistake> mistakes = {};  ///< where they are asked for
  std::optional<changes::TeachingScore> teaching = {};
};

/// A kitchen, and where days can be in it.
struct Kitchen {
  fs::path urdf;
  changes::DayWorld world;
};

std::vector<Kitchen> kitchens_of(const Arguments& arguments, Warnings& warnings) {
  if (!arguments.map.empty() && arguments.worlds.size() != 1)
    throw Error("--map is of one kitchen", {}, "name that KITCHEN");
  std::vector<Kitchen> kitchens;
  for (const std::string& world : arguments.worlds)
    kitchens.push_back(
        {fs::absolute(world),
         changes::find_day_world(world, {arguments.package_paths.begin(), arguments.package_paths.end()},
                                 arguments.seed, warnings)});
  if (!kitchens.empty()) return kitchens;
  for (const char* name : {"kitchen", "kitchen_l"})
    kitchens.push_back(
        {fs::absolute(fs::path(arguments.samples) / name) += ".urdf", changes::sample_day_world(name)});
  return kitchens;
}

/// One day in a kitchen, by the memory and by the baselines.
DayResult one_day(const Arguments& arguments, const Kitchen& kitchen, int run, const fs::path& folder,
                  Progress& progress, Session& session) {
  const fs::path day = folder / fmt::format("day_{}", run + 1), scenario = day.string() + ".yaml";
  const uint64_t seed = arguments.seed + static_cast<uint64_t>(run);
  write_file_atomically(
      scenario, changes::random_day(kitchen.world, kitchen.urdf, seed, arguments.scenes, arguments.drawers));
  mapping::RecordOptions record_options;
  record_options.seed = static_cast<int>(seed);
  record_options.threads = session.flags().threads;
  record_options.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
  PartialProgress recording_it(progress, 0, 0.6), remembering(progress, 0.6, 1);
  record(mapping::read_scenario(scenario), day, record_options, recording_it, session.warnings());
  const std::shared_ptr<mapping::Recording> recording = mapping::open_recording(day);
  changes::RememberOptions options;
  options.memory = day.string() + ".loci";
  options.map = arguments.map.empty() ? kitchen.urdf : fs::path(arguments.map);
  options.package_paths = record_options.package_paths;
  options.program = "loci-evaluate days";
  options.threads = session.flags().threads;
  fs::remove(options.memory);
  changes::remember(recording, options, remembering, session.warnings());
  const memory::Store store = memory::Store::open_read(options.memory);
  std::vector<changes::TrueObject> clutter;
  if (!arguments.map.empty())
    clutter = changes::clutter_of(kitchen.urdf, record_options.package_paths, session.warnings());
  DayResult result{changes::compare_all(day, *recording, store, clutter), changes::score_answers(day, store)};
  if (!arguments.mistakes.empty())
    result.mistakes = changes::worst_mistakes(result.methods.front(), day, *recording, store);
  if (arguments.teach) result.teaching = changes::score_teaching(day, *recording, options.memory);
  return result;
}

void run(const Arguments& arguments, Session& session) {
  const TemporaryFolder temporary("loci-evaluate-days");
  const fs::path folder = arguments.keep.empty() ? temporary.path() : fs::path(arguments.keep);
  make_folder(folder);
  if (!arguments.mistakes.empty()) {
    make_folder(arguments.mistakes);
    session.check_outputs(arguments.mistakes, {changes::kMistakesFile});
  }
  const std::vector<Kitchen> kitchens = kitchens_of(arguments, session.warnings());
  std::vector<changes::Comparison> all;
  std::vector<changes::Mistake> mistakes;
  changes::AnswerScore answers;
  changes::TeachingScore teaching;
  std::string text;
  Json days = Json::array();
  for (int i = 0; i < arguments.runs; ++i) {
    PartialProgress progress(session.progress(), double(i) / arguments.runs, double(i + 1) / arguments.runs);
    const DayResult result =
        one_day(arguments, kitchens[static_cast<size_t>(i) % kitchens.size()], i, folder, progress, session);
    const std::vector<changes::Comparison>& day = result.methods;
    answers.add(result.answers);
    mistakes.insert(mistakes.end(), result.mistakes.begin(), result.mistakes.end());
    if (result.teaching) teaching.add(*result.teaching);
    text += fmt::format("day {}: {} of {} right; identity F1 {:.3f}, {:.3f}, {:.3f}\n", i + 1, day[0].right(),
                        day[0].certain(), day[0].identity_f1(), day[1].identity_f1(), day[2].identity_f1());
    days.push_back(
        {{"right", day[0].right()}, {"certain", day[0].certain()}, {"identity_f1", day[0].identity_f1()}});
    all.resize(day.size());
    for (size_t method = 0; method < day.size(); ++method) all[method].add(day[method]);
  }
  if (!arguments.diagrams.empty()) {
    std::vector<std::pair<std::string, changes::Stated>> stated = changes::stated_associations(all);
    stated.emplace_back("existence", answers.existence_stated);
    stated.emplace_back("place", answers.place_stated);
    stated.emplace_back("was", answers.was_stated);
    write_file_atomically(arguments.diagrams, changes::reliability_diagrams(stated));
  }
  if (!arguments.mistakes.empty())
    write_file_atomically(fs::path(arguments.mistakes) / changes::kMistakesFile,
                          changes::mistakes_page(mistakes));
  Json json = changes::to_json(all);
  json.erase("transitions");
  json.erase("statements");
  json["days"] = days;
  json["answers"] = to_json(answers);
  text += "\n" + changes::text(all, false) + "\n" + changes::text(answers);
  if (arguments.teach) {
    json["teaching"] = to_json(teaching);
    text += changes::text(teaching);
  }
  session.answer(text, json);
}

}  // namespace

Command days_command() {
  return {"days",
          "Events and identities on random simulated days against baselines",
          {"loci-evaluate days --runs 1 --scenes 4",
           "loci-evaluate days --runs 1 --scenes 3 --seed 4 --teach --json",
           "loci-evaluate days apps/samples/kitchen.urdf --runs 1 --scenes 3"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("[KITCHEN...]", &arguments->worlds,
                             "Worlds (URDF) to have days in, instead of the two sample kitchens");
            table.option("--runs N", &arguments->runs, "Number of days; the kitchens take turns",
                         {.min = 1, .max = 1000});
            table.option("--scenes N", &arguments->scenes,
                         "Number of scenes per day; the middle cup is back after 12", {.min = 1, .max = 100});
            table.option("--seed N", &arguments->seed, "Seed of the first day; later days count on");
            table.flag("--drawers", arguments->drawers, "Drawers are used, too, in the sample kitchens");
            table.flag("--teach", arguments->teach,
                       "Teach half of the classes by an example each, then the others, and count what all "
                       "other objects are called");
            table.option("--samples FOLDER", &arguments->samples,
                         "Folder of kitchen.urdf and kitchen_l.urdf");
            table.package_path(&arguments->package_paths);
            table.option("--map MAP", &arguments->map,
                         "Perceive against this map (URDF) instead of the world itself");
            table.option("--diagrams FILE", &arguments->diagrams,
                         "Draw reliability diagrams (SVG) of association, existence, place and was",
                         {.replaces = true});
            table.option("--mistakes FOLDER", &arguments->mistakes,
                         "Write mistakes.html, a page of the ten worst mistakes, into this folder",
                         {.replaces = true});
            table.option("-o,--output FOLDER", &arguments->keep,
                         "Keep scenarios, recordings and memories in this folder");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
