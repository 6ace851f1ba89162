#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "apps/evaluate/nbv/exploration.h"
#include "mapping/base/text/json.h"

namespace loci::apps::nbv_evaluation {
namespace {

const std::vector<std::pair<std::string, std::string>> kColors = {
    {"ours", "#c22"}, {"exhaustive", "#222"}, {"frontier", "#27c"}, {"random", "#999"}};

double mean(const std::vector<double>& values) {
  return values.empty()
             ? 0
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<const Run*> runs_of(const WorldResult& result, const std::string& strategy) {
  std::vector<const Run*> runs;
  for (const Run& run : result.runs)
    if (run.strategy == strategy) runs.push_back(&run);
  return runs;
}

/// Coverage after n scans, mean over runs; those that have stopped keep theirs.
double coverage_after(const std::vector<const Run*>& runs, size_t scans) {
  std::vector<double> values;
  for (const Run* run : runs) values.push_back(run->coverage[std::min(scans, run->coverage.size()) - 1]);
  return mean(values);
}

/// What a row of the table says about a strategy in a world.
struct Row {
  double final_coverage = 0, lowest_coverage = 1, scans_made = 0, scans_to_goal = 0, seconds = 0,
         max_seconds = 0, cpu_seconds = 0, overlap = 0;
  int reached = 0, runs = 0;
  bool cut = false;
};

Row row_of(const std::vector<const Run*>& runs, double goal) {
  Row row;
  std::vector<double> final_coverage, made, to_goal, seconds, processor, overlap;
  for (const Run* run : runs) {
    final_coverage.push_back(run->coverage.back());
    made.push_back(static_cast<double>(run->coverage.size()));
    if (const int scans = run->scans_to(goal); scans > 0) to_goal.push_back(scans);
    seconds.insert(seconds.end(), run->seconds.begin(), run->seconds.end());
    processor.insert(processor.end(), run->cpu_seconds.begin(), run->cpu_seconds.end());
    overlap.insert(overlap.end(), run->overlap.begin(), run->overlap.end());
    row.cut = row.cut || run->cut;
  }
  row.runs = static_cast<int>(runs.size());
  row.reached = static_cast<int>(to_goal.size());
  row.final_coverage = mean(final_coverage);
  row.lowest_coverage =
      final_coverage.empty() ? 0 : *std::min_element(final_coverage.begin(), final_coverage.end());
  row.scans_made = mean(made);
  row.scans_to_goal = mean(to_goal);
  row.seconds = mean(seconds);
  row.max_seconds = seconds.empty() ? 0 : *std::max_element(seconds.begin(), seconds.end());
  row.cpu_seconds = mean(processor);
  row.overlap = mean(overlap);
  return row;
}

}  // namespace

std::string table_of_results(const std::vector<WorldResult>& results, double goal) {
  std::string text = fmt::format(
      "| world | planner | coverage at its stop (lowest) | scans made | scans to {:.0f} % (runs that got "
      "there) | decision, mean (max) | its CPU time, all threads | times ours |\n"
      "|---|---|---|---|---|---|---|---|\n",
      100 * goal);
  for (const WorldResult& result : results) {
    const double ours = row_of(runs_of(result, "ours"), goal).cpu_seconds;
    for (const auto& [name, color] : kColors) {
      const Row row = row_of(runs_of(result, name), goal);
      if (row.runs == 0) continue;
      text += fmt::format(
          "| {} | {} | {:.1f} % ({:.1f} %) | {:.1f} | {} | {:.3f} s ({:.3f} s){} | {:.3f} s | {:.1f} |\n",
          result.world, name, 100 * row.final_coverage, 100 * row.lowest_coverage, row.scans_made,
          row.reached > 0 ? fmt::format("{:.1f} ({} of {})", row.scans_to_goal, row.reached, row.runs)
                          : fmt::format("– (0 of {})", row.runs),
          row.seconds, row.max_seconds, row.cut ? ", cut" : "", row.cpu_seconds,
          ours > 0 ? row.cpu_seconds / ours : 0);
    }
  }
  return text;
}

Json json_of_results(const std::vector<WorldResult>& results, double goal) {
  Json json = Json::array();
  for (const WorldResult& result : results) {
    Json world = {{"world", result.world}, {"places", result.places}, {"surface_voxels", result.surface}};
    for (const auto& [name, color] : kColors) {
      const Row row = row_of(runs_of(result, name), goal);
      if (row.runs == 0) continue;
      world["planners"][name] = {{"coverage", row.final_coverage},
                                 {"coverage_lowest", row.lowest_coverage},
                                 {"scans", row.scans_made},
                                 {"scans_to_goal", row.reached > 0 ? Json(row.scans_to_goal) : Json()},
                                 {"runs_at_goal", row.reached},
                                 {"runs", row.runs},
                                 {"decision_s", row.seconds},
                                 {"decision_max_s", row.max_seconds},
                                 {"decision_processor_s", row.cpu_seconds},
                                 {"overlap", row.overlap},
                                 {"cut", row.cut}};
    }
    for (const Run& run : result.runs)
      world["runs"].push_back({{"planner", run.strategy},
                               {"start", {run.start.x, run.start.y, run.start.yaw}},
                               {"coverage", run.coverage},
                               {"decision_s", run.seconds},
                               {"decision_processor_s", run.cpu_seconds},
                               {"overlap", run.overlap},
                               {"stopped", run.stopped},
                               {"cut", run.cut}});
    json.push_back(world);
  }
  return json;
}

std::string coverage_svg(const std::vector<WorldResult>& results, double goal) {
  constexpr double kWidth = 300, kHeight = 220, kLeft = 46, kTop = 34, kGap = 30;
  size_t scans = 2;
  for (const WorldResult& result : results)
    for (const Run& run : result.runs) scans = std::max(scans, run.coverage.size());
  const double total = kLeft + static_cast<double>(results.size()) * (kWidth + kGap);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"11\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      total, kTop + kHeight + 56);
  for (size_t panel = 0; panel < results.size(); ++panel) {
    const double left = kLeft + static_cast<double>(panel) * (kWidth + kGap);
    const auto x = [&](size_t n) {
      return left + kWidth * static_cast<double>(n - 1) / static_cast<double>(scans - 1);
    };
    const auto y = [&](double coverage) { return kTop + kHeight * (1 - coverage); };
    svg +=
        fmt::format("<text x=\"{:.0f}\" y=\"20\" font-size=\"13\">{}</text>\n", left, results[panel].world);
    for (const double tick : {0.0, 0.25, 0.5, 0.75, 1.0})
      svg += fmt::format(
          "<path d=\"M{0:.1f} {1:.1f}H{2:.1f}\" stroke=\"#ddd\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
          "text-anchor=\"end\">{5:.0f} %</text>\n",
          left, y(tick), left + kWidth, left - 4, y(tick) + 4, 100 * tick);
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#7a7\" stroke-dasharray=\"4 3\"/>\n", left,
                       y(goal), left + kWidth);
    for (size_t n = 1; n <= scans; n += scans > 10 ? 2 : 1)
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x(n),
                         kTop + kHeight + 15, n);
    for (const auto& [name, color] : kColors) {
      const auto runs = runs_of(results[panel], name);
      if (runs.empty()) continue;
      std::string path;
      for (size_t n = 1; n <= scans; ++n)
        path += fmt::format("{}{:.1f} {:.1f}", n == 1 ? "M" : "L", x(n), y(coverage_after(runs, n)));
      svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", path, color);
    }
  }
  for (size_t i = 0; i < kColors.size(); ++i)
    svg += fmt::format("<text x=\"{0:.0f}\" y=\"{1:.0f}\" fill=\"{2}\">— {3}</text>\n",
                       kLeft + 90 * static_cast<double>(i), kTop + kHeight + 44, kColors[i].second,
                       kColors[i].first);
  return svg + "</svg>\n";
}

}  // namespace loci::apps::nbv_evaluation
