#include "nbv/survey_report.h"

#include <fmt/format.h>

#include "mapping/base/html.h"
#include "mapping/exchange/map_report.h"

namespace loci {
namespace {

std::string steps_table(const SurveyResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (size_t i = 0; i < result.steps.size(); ++i) {
    const ExplorationStep& step = result.steps[i];
    rows.push_back(
        {std::to_string(i),
         fmt::format("{:.2f}, {:.2f}, {:.0f}°", step.goal.x, step.goal.y, step.goal.yaw * 180 / M_PI),
         step.reason, i == 0 ? "" : fmt::format("{:.0f} %", 100 * step.expected_overlap),
         i == 0 ? "" : fmt::format("{:.0f} %", 100 * step.reached_overlap), std::to_string(step.known_voxels),
         std::to_string(step.fringe_voxels),
         fmt::format("{:.2f} / {:.2f} / {:.2f} / {:.2f}", step.scan_seconds, step.register_seconds,
                     step.insert_seconds, step.plan_seconds)});
  }
  return html_table({"scan", "x, y, yaw", "why there", "overlap planned", "overlap reached", "known leaves",
                     "fringe left", "s: scan / register / insert / plan"},
                    rows);
}

std::string pulls_table(const SurveyResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const Interaction& pull : result.interactions) {
    const auto& joint = pull.difference.joint;
    rows.push_back({pull.front, std::to_string(pull.stop), pull.held ? "yes" : "no",
                    joint ? joint_estimate_type_name(joint->type) : "",
                    joint ? fmt::format("{:.3f}", pull.difference.moved) : "",
                    joint ? fmt::format("{:.2f}", joint->axis_sd_deg) : "", pull.difference.reason});
  }
  return html_table({"front", "stop", "held", "joint", "moved (m or rad)", "axis ± °", "remark"}, rows);
}

}  // namespace

std::string survey_report(const SurveyResult& result, const std::string& input) {
  std::string page = map_report(result.map, result.scans, input);
  const std::string stop = "<p>It ended: " + html_escape(result.stop_reason) + ".</p>";
  page = html_with_section(page, "exploration",
                           html_section("exploration", "Exploration", stop + steps_table(result)));
  if (!result.interactions.empty())
    page = html_with_section(page, "interaction",
                             html_section("interaction", "Pulled handles", pulls_table(result)));
  return page;
}

}  // namespace loci
