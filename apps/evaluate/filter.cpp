#include "apps/evaluate/commands.h"
#include "apps/evaluate/filter/joints.h"
#include "apps/evaluate/filter/phantoms.h"
#include "apps/evaluate/filter/removal.h"
#include "apps/evaluate/filter/speed.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace filter_evaluation;

struct Arguments {
  std::vector<std::string> recordings;
  std::string map;
  std::vector<std::string> package_paths;
  std::string output;
  filter_evaluation::SpeedOptions speed;
  perception::KnownStructureOptions filter;
  bool pose_errors = false;
  bool joints = false;
};

void run_speed(const Arguments& arguments, Session& session) {
  const filter_evaluation::Speed speed = measure_speed(arguments.speed, session.progress());
  if (!arguments.output.empty()) {
    make_folder(arguments.output);
    write_file_atomically(std::filesystem::path(arguments.output) / "speed.svg", speed_svg(speed));
  }
  session.answer(speed.text(), speed.to_json());
}

void run_recordings(const Arguments& arguments, Session& session) {
  if (arguments.map.empty()) throw Error("recordings are filtered against a map", {}, "--map MAP.urdf");
  const auto map = perception::KnownMap::load(
      arguments.map, {arguments.package_paths.begin(), arguments.package_paths.end()}, session.warnings());
  std::vector<filter_evaluation::Removal> removals;
  for (const std::string& recording : arguments.recordings)
    removals.push_back(filter_evaluation::measure_removal(recording, *map, arguments.filter,
                                                          session.flags().threads, session.progress()));
  std::string text = removal_text(removals);
  Json json = {{"removal", removal_json(removals)}};
  if (arguments.pose_errors)
    for (const std::string& recording : arguments.recordings) {
      const std::vector<filter_evaluation::Phantoms> rows =
          measure_phantoms(recording, map, {{0, 0}, {0.01, 0.5}, {0.02, 1}, {0.03, 1.5}, {0.05, 2}},
                           arguments.speed.seed, session.flags().threads, session.progress());
      text += "\n" + phantoms_text(rows);
      json["pose_errors"].push_back({{"recording", recording}, {"rows", phantoms_json(rows)}});
    }
  if (arguments.joints) {
    std::vector<filter_evaluation::JointFits> fits;
    for (const std::string& recording : arguments.recordings)
      fits.push_back(
          filter_evaluation::measure_joints(recording, *map, session.flags().threads, session.progress()));
    text += "\n" + joints_text(fits);
    json["joints"] = joints_json(fits);
  }
  session.answer(text, json);
}

void run(Arguments& arguments, Session& session) {
  table_of(arguments.speed).validate();
  table_of(arguments.filter).validate();
  arguments.recordings.empty() ? run_speed(arguments, session) : run_recordings(arguments, session);
}

}  // namespace

Command filter_command() {
  return {"filter",
          "Known structure: time to render thousands of meshes, or points left in recordings",
          {"loci-evaluate filter --meshes 200 --robots 2 --steps 1 --repeats 1",
           "loci-evaluate filter demo-output/day --map demo-output/explored/map.urdf --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("[RECORDING...]", &arguments->recordings,
                             "Recordings to filter; without any, time is measured");
            table.option("--map MAP", &arguments->map, "URDF of the map; the sidecar is found beside it");
            table.package_path(&arguments->package_paths);
            table.flag("--pose-errors", arguments->pose_errors,
                       "Effect of localisation errors on the objects found, with and without refinement");
            table.flag("--joints", arguments->joints,
                       "Accuracy of the states of drawers and doors estimated from depth images");
            table.option("-o,--output FOLDER", &arguments->output, "Folder for the figure as SVG");
            table.options(table_of(arguments->speed), "Time");
            table.options(table_of(arguments->filter), "Filter");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
