#include "nbv/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/exchange/map_report.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/world/map_files.h"
#include "mapping/world/urdf.h"
#include "nbv/images.h"

namespace loci::nbv {
namespace {

namespace fs = std::filesystem;

/// Of the scans: of a map that less went into, what is missing was perhaps not seen at all.
constexpr double kMinRegistered = 2.0 / 3;

/// Where the images of the plan after a step are.
fs::path plan_folder(const fs::path& folder, size_t step) {
  return folder / "plans" / fmt::format("after_scan_{:03}", step);
}

std::string steps_table(const SurveyResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (size_t i = 0; i < result.steps.size(); ++i) {
    const ExplorationStep& step = result.steps[i];
    rows.push_back({std::to_string(i),
                    fmt::format("{:.2f}, {:.2f}, {:.0f}°", step.goal.x, step.goal.y, step.goal.yaw / kDegree),
                    step.reason, i == 0 ? "" : fmt::format("{:.0f} %", 100 * step.expected_overlap),
                    i == 0 ? "" : fmt::format("{:.0f} %", 100 * step.reached_overlap),
                    std::to_string(step.known_voxels), std::to_string(step.frontier_voxels),
                    fmt::format("{:.2f} / {:.2f} / {:.2f} / {:.2f}", step.scan_seconds, step.register_seconds,
                                step.insert_seconds, step.plan_seconds)});
  }
  return html_table({"scan", "x, y, yaw", "why there", "overlap planned", "overlap reached", "known leaves",
                     "frontier left", "s: scan / register / insert / plan"},
                    rows);
}

std::string pulls_table(const SurveyResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const Interaction& pull : result.interactions) {
    const auto& joint = pull.difference.joint;
    rows.push_back({pull.front.value_or("none"), pull.pulled_as, std::to_string(pull.base_pose),
                    pull.held ? "yes" : "no", joint ? to_text(joint->type) : "",
                    joint ? fmt::format("{:.3f}", pull.difference.moved) : "",
                    joint ? fmt::format("{:.2f}", joint->axis_sd_deg) : "", pull.difference.reason});
  }
  return html_table(
      {"front", "pulled as", "base pose", "held", "joint", "moved (m or rad)", "axis ± °", "remark"}, rows);
}

/// What was known, the votes, and the choice, side by side; "" where nothing was planned.
std::string plan_images(const fs::path& folder, size_t step) {
  constexpr std::array<std::pair<const char*, const char*>, 4> kImages = {
      {{"frontier", "known space and frontier"},
       {"costs_frontier", "C_F, frontier that would be seen (dark = much); obstacles in blue"},
       {"costs_occupied", "C_O, surfaces that would be seen again (dark = many)"},
       {"samples", "C, samples (blue) and the choice (red)"}}};
  std::string cells;
  for (const auto& [name, title] : kImages) {
    const fs::path file = plan_folder(folder, step) / (std::string(name) + ".png");
    if (!fs::exists(file)) return "";
    const std::string bytes = read_file(file);
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    cells += "<td style=\"width:25%\">" + html_image({data, bytes.size()}, "image/png", title) + "<br>" +
             html_escape(title) + "</td>";
  }
  return fmt::format("<h3>After scan {}</h3><table><tr>{}</tr></table>", step, cells);
}

/// The report of the map, followed by the exploration (every scan with its reason, overlap, coverage, times
/// and images of the plan, Fig. 7.2 and 7.4) and by every pull with its result.
std::string survey_report(const SurveyResult& result, const fs::path& folder, Warnings& warnings) {
  std::string page = map_report(result.map, result.scans, folder.string(),
                                glb_bytes(result.map.world, {{}, folder}, warnings));
  std::string images;
  for (size_t i = 0; i < result.steps.size(); ++i) images += plan_images(folder, i);
  const std::string stop = "<p>It ended: " + html_escape(result.stop_reason) + ".</p>";
  page = html_with_section(page, "exploration",
                           html_section("exploration", "Exploration", stop + steps_table(result) + images));
  if (!result.interactions.empty())
    page = html_with_section(page, "interaction",
                             html_section("interaction", "Pulled handles", pulls_table(result)));
  return page;
}

}  // namespace

void SurveyOptions::declare(OptionTable& table) {
  exploration.declare(table);
  interpretation.declare(table);
  interaction.declare(table);
}

bool SurveyResult::usable() const {
  return static_cast<double>(scans.scans.size()) >= kMinRegistered * static_cast<double>(steps.size());
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
    json["front"] = pull.front ? Json(*pull.front) : Json();
    json["pulled_as"] = pull.pulled_as;
    json["base_pose"] = pull.base_pose;
    json["held"] = pull.held;
    pulls.push_back(json);
  }
  return {{"usable", usable()},         {"scans", steps.size()}, {"registered", scans.scans.size()},
          {"stop_reason", stop_reason}, {"interactions", pulls}, {"map", map.report()},
          {"seconds", seconds}};
}

SurveyResult survey(mapping::Robot& robot, const mapping::PlanarPose& start,
                    const std::filesystem::path& folder, bool resume, const SurveyOptions& options,
                    Progress& progress, Warnings& warnings) {
  const Stopwatch watch;
  SurveyOptions checked = options;
  table_of(checked).validate({"", 0, "explore"});
  static_cast<void>(mapping::FloorRegion(checked.exploration.planner.within));  // Error for what is none.
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
    const auto names = replace_fronts(std::move(fronts), result.map);
    for (Interaction& pull : result.interactions)
      if (const auto now = names.find(pull.pulled_as); now != names.end()) pull.front = now->second;
  }
  if (!result.map.usable())
    throw Error(result.map.summary(), {folder.string(), 0, ""}, "the scans were kept");

  progress.check(0.98, "writes the map");
  result.seconds = watch.seconds();
  color_links(result.scans, checked.exploration.threads, result.map);
  result.map.world.name = mapping::map_name(folder);
  if (checked.map_from_input) result.map.semantics.map_from_input = checked.map_from_input;
  write_map(result.map.world, result.map.semantics, folder / "map.urdf");
  write_file_atomically(folder / "report.html", survey_report(result, folder, warnings));
  return result;
}

}  // namespace loci::nbv
