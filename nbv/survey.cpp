#include "nbv/survey.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "mapping/base/stopwatch.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/world/urdf.h"
#include "nbv/images.h"
#include "nbv/survey_report.h"

namespace loci::nbv {

void SurveyOptions::declare(OptionTable& table) {
  exploration.declare(table);
  interpretation.declare(table);
  interaction.declare(table);
}

std::string SurveyResult::summary() const {
  std::string text =
      fmt::format("{} scans, {} registered; it ended: {}\n", steps.size(), scans.scans.size(), stop_reason);
  if (!interactions.empty()) {
    const auto moved = std::count_if(interactions.begin(), interactions.end(), [](const Interaction& pull) {
      return pull.difference.joint.has_value();
    });
    text += fmt::format("{} handles pulled, {} parts moved\n", interactions.size(), moved);
  }
  return text + map.summary() + "\n";
}

Json SurveyResult::report() const {
  Json pulls = Json::array();
  for (const Interaction& pull : interactions) {
    Json json = pull.difference.report();
    json["front"] = pull.front;
    json["stop"] = pull.stop;
    json["held"] = pull.held;
    pulls.push_back(json);
  }
  return {{"scans", steps.size()},      {"registered", scans.scans.size()},
          {"stop_reason", stop_reason}, {"interactions", pulls},
          {"map", map.report()},        {"seconds", seconds}};
}

SurveyResult survey(mapping::Robot& robot, const mapping::PlanarPose& start,
                    const std::filesystem::path& folder, bool resume, const SurveyOptions& options,
                    Progress& progress, Warnings& warnings) {
  const Stopwatch watch;
  SurveyOptions checked = options;
  table_of(checked).validate({"", 0, "explore"});
  FloorRegion(checked.exploration.planner.within);  // Error for what is none.
  checked.exploration.forward_threads();
  checked.interpretation.threads = checked.exploration.threads;
  make_folder(folder);
  SurveyResult result;

  Exploration exploration(robot, start, folder, resume, checked.exploration, warnings);
  exploration.watch_plans([&](size_t step, const ViewPlan& plan, const mapping::PlanarPose& stands) {
    write_view_images(plan, stands, plan_folder(folder, step));
  });
  PartialProgress exploring(progress, 0, checked.interact ? 0.4 : 0.8);
  exploration.run(exploring);
  result.steps = exploration.steps();
  result.stop_reason = exploration.stop_reason();
  result.scans = exploration.registered_scans();

  PartialProgress interpreting(progress, checked.interact ? 0.4 : 0.8, checked.interact ? 0.5 : 0.98);
  result.map = interpret(result.scans, checked.interpretation, interpreting);
  if (checked.interact) {
    PartialProgress pulling(progress, 0.5, 0.98);
    std::vector<mapping::Front> fronts = result.map.fronts;
    result.fronts_before = fronts;
    result.interactions = interact(robot, exploration, fronts, folder, resume, checked.exploration,
                                   checked.interaction, pulling, warnings);
    replace_fronts(std::move(fronts), result.map);
  }
  if (!result.map.usable())
    throw Error(result.map.summary(), {folder.string(), 0, ""}, "the scans were kept");

  progress.check(0.98, "writes the map");
  result.seconds = watch.seconds();
  write_urdf(result.map.world, folder / "map.urdf");
  write_semantic_map(result.map.semantics, folder / "map.semantic.json");
  write_file_atomically(folder / "report.html", survey_report(result, folder));
  return result;
}

}  // namespace loci::nbv
