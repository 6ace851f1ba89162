#include <fmt/format.h>

#include <algorithm>

#include "apps/evaluate/filter/speed.h"
#include "mapping/base/text/json.h"

namespace loci::apps::filter_evaluation {
namespace {

constexpr double kWidth = 420, kHeight = 260, kLeft = 52, kTop = 34, kGap = 80;

Json json_of(const Time& time) {
  return {{"clock_ms", time.clock_ms}, {"processor_ms", time.processor_ms}};
}

struct Line {
  std::string name, color;
  std::vector<std::pair<double, double>> points;
};

/// A panel of the image: lines from 0, with the 30 ms that an image may take.
std::string panel(double left, const std::string& title, const std::string& below,
                  const std::vector<Line>& lines) {
  double max_x = 1, max_y = 35;
  for (const Line& line : lines)
    for (const auto& [x, y] : line.points) {
      max_x = std::max(max_x, x);
      max_y = std::max(max_y, 1.05 * y);
    }
  const auto at_x = [&](double x) { return left + kWidth * x / max_x; };
  const auto at_y = [&](double y) { return kTop + kHeight * (1 - y / max_y); };
  std::string svg = fmt::format("<text x='{}' y='18' font-weight='bold'>{}</text>\n", left, title);
  const double step = max_y > 300 ? 100 : max_y > 120 ? 50 : 10;
  for (double y = 0; y <= max_y; y += step)
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{1:.1f}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/>"
        "<text x='{3:.1f}' y='{4:.1f}' text-anchor='end'>{5:g}</text>\n",
        left, left + kWidth, at_y(y), left - 5, at_y(y) + 4, y);
  for (int i = 0; i <= 5; ++i)
    svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{:g}</text>\n", at_x(max_x * i / 5),
                       kTop + kHeight + 16, max_x * i / 5);
  svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{}</text>\n", left + kWidth / 2,
                     kTop + kHeight + 34, below);
  svg += fmt::format(
      "<line x1='{0:.1f}' x2='{1:.1f}' y1='{2:.1f}' y2='{2:.1f}' stroke='#888' stroke-dasharray='4 3'/>\n",
      left, left + kWidth, at_y(30));
  for (size_t i = 0; i < lines.size(); ++i) {
    std::string points;
    for (const auto& [x, y] : lines[i].points) points += fmt::format("{:.1f},{:.1f} ", at_x(x), at_y(y));
    svg += fmt::format(
        "<polyline points='{0}' fill='none' stroke='{1}' stroke-width='1.8'/>\n"
        "<text x='{2:.1f}' y='{3:.1f}' fill='{1}'>{4}</text>\n",
        points, lines[i].color, left + 8, kTop + 14 + 15 * static_cast<double>(i), lines[i].name);
  }
  return svg;
}

}  // namespace

std::string Speed::text() const {
  std::string text =
      "| meshes | two threads, clock (processor) | one thread | without culling, two | Embree's rays, one | "
      "its tree | same pixels | pixels over 2 mm from the rays |\n|---|---|---|---|---|---|---|---|\n";
  for (const CrowdTimes& t : crowds)
    text += fmt::format(
        "| {} | {:.1f} ms ({:.1f}) | {:.1f} ms ({:.1f}) | {:.0f} ms ({:.0f}) | {:.0f} ms ({:.0f}) | {:.0f} "
        "ms | "
        "{} | {} |\n",
        t.meshes, t.two.clock_ms, t.two.processor_ms, t.one.clock_ms, t.one.processor_ms, t.all.clock_ms,
        t.all.processor_ms, t.rays.clock_ms, t.rays.processor_ms, t.tree_ms, t.same_pixels ? "yes" : "NO",
        t.different);
  text += "\n| robots | joints to poses | drawn, two threads, clock (processor) |\n|---|---|---|\n";
  for (const RobotTimes& t : robots)
    text += fmt::format("| {} | {:.2f} ms | {:.1f} ms ({:.1f}) |\n", t.robots, t.update.clock_ms,
                        t.draw.clock_ms, t.draw.processor_ms);
  return text;
}

Json Speed::to_json() const {
  Json json = {{"meshes", Json::array()}, {"robots", Json::array()}};
  for (const CrowdTimes& t : crowds)
    json["meshes"].push_back({{"count", t.meshes},
                              {"two_threads", json_of(t.two)},
                              {"one_thread", json_of(t.one)},
                              {"without_culling", json_of(t.all)},
                              {"embree", json_of(t.rays)},
                              {"embree_tree_ms", t.tree_ms},
                              {"same_pixels", t.same_pixels},
                              {"different_pixels", t.different}});
  for (const RobotTimes& t : robots)
    json["robots"].push_back({{"count", t.robots}, {"update", json_of(t.update)}, {"draw", json_of(t.draw)}});
  return json;
}

std::string speed_svg(const Speed& speed) {
  Line update{"joints to poses", "#2166ac", {}}, sum{"and drawn, two threads, CPU time", "#b2182b", {}};
  for (const RobotTimes& t : speed.robots) {
    update.points.emplace_back(t.robots, t.update.processor_ms);
    sum.points.emplace_back(t.robots, t.update.processor_ms + t.draw.processor_ms);
  }
  Line clock{"two threads, wall time", "#b2182b", {}}, processor{"two threads, CPU time", "#e08214", {}},
      rays{"Embree's rays, one thread, CPU time", "#2166ac", {}};
  for (const CrowdTimes& t : speed.crowds) {
    clock.points.emplace_back(t.meshes, t.two.clock_ms);
    processor.points.emplace_back(t.meshes, t.two.processor_ms);
    if (t.rays.processor_ms > 0) rays.points.emplace_back(t.meshes, t.rays.processor_ms);
  }
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
             "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
             kLeft + 2 * kWidth + kGap + 20, kTop + kHeight + 48) +
         panel(kLeft, "Robots of 45 meshes, as Fig. 4.15", "robots (ms)", {update, sum}) +
         panel(kLeft + kWidth + kGap, "Meshes of 3,500 vertices, as Fig. 4.16", "meshes (ms)",
               {clock, processor, rays}) +
         "</svg>\n";
}

}  // namespace loci::apps::filter_evaluation
