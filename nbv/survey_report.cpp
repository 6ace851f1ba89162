#include "nbv/survey_report.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mapping/base/files.h"
#include "mapping/base/html.h"
#include "mapping/base/math.h"
#include "mapping/exchange/map_report.h"

namespace loci::nbv {

namespace fs = std::filesystem;

namespace {

std::string steps_table(const SurveyResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (size_t i = 0; i < result.steps.size(); ++i) {
    const ExplorationStep& step = result.steps[i];
    rows.push_back(
        {std::to_string(i),
         fmt::format("{:.2f}, {:.2f}, {:.0f}°", step.goal.x, step.goal.y, step.goal.yaw * 180 / kPi),
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
                    joint ? to_text(joint->type) : "",
                    joint ? fmt::format("{:.3f}", pull.difference.moved) : "",
                    joint ? fmt::format("{:.2f}", joint->axis_sd_deg) : "", pull.difference.reason});
  }
  return html_table({"front", "stop", "held", "joint", "moved (m or rad)", "axis ± °", "remark"}, rows);
}

/// What was known, the votes, and the choice, side by side; "" where nothing was planned.
std::string plan_images(const fs::path& folder, size_t step) {
  constexpr std::array<std::pair<const char*, const char*>, 4> kImages = {
      {{"fringe", "known space and fringe"},
       {"costs_fringe", "C_F, fringe that would be seen (dark = much); obstacles in blue"},
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

}  // namespace

fs::path plan_folder(const fs::path& folder, size_t step) {
  return folder / "plans" / fmt::format("after_scan_{:03}", step);
}

std::string survey_report(const SurveyResult& result, const fs::path& folder) {
  std::string page = map_report(result.map, result.scans, folder.string());
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

}  // namespace loci::nbv
