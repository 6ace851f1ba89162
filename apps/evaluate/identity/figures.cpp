#include "apps/evaluate/identity/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/base/text/html.h"

namespace loci::apps::identity_experiment {
namespace {

constexpr double kWidth = 420, kHeight = 280, kMargin = 46;
constexpr double kMin = 0.6;  ///< of the vertical axis
constexpr const char* kColors[] = {"#1b7837", "#2166ac", "#e08214", "#b2182b", "#762a83", "#555555"};

double y_of(double fraction) {
  return kHeight - kMargin - (std::max(kMin, fraction) - kMin) / (1 - kMin) * (kHeight - kMargin - 24);
}

double x_of(int number, int first, int last) {
  return kMargin +
         (last == first ? 0.5 : double(number - first) / double(last - first)) * (kWidth - kMargin - 80);
}

std::string axes(const std::string& title, const std::string& label, int first, int last) {
  std::string svg =
      fmt::format("<text x='{}' y='14' font-weight='bold'>{}</text>\n", kMargin, html_escape(title));
  for (double tick = kMin; tick <= 1.001; tick += 0.1)
    svg += fmt::format(
        "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' "
        "text-anchor='end'>{5:.0f} %</text>\n",
        kMargin, kWidth - 80, y_of(tick), kMargin - 4, y_of(tick) + 4, 100 * tick);
  for (int number = first; number <= last; ++number)
    svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{}</text>\n", x_of(number, first, last),
                       kHeight - kMargin + 16, number);
  return svg + fmt::format("<text x='{}' y='{}' text-anchor='middle'>{}</text>\n", kWidth / 2 - 17,
                           kHeight - 10, html_escape(label));
}

std::string lines(const ExperimentResult& result, const std::string& model,
                  std::map<int, Success> Score::*numbers, Tally Success::*part, int first, int last) {
  std::string svg;
  for (size_t level = 0; level < result.levels.size(); ++level) {
    const char* color = kColors[level % std::size(kColors)];
    std::string points;
    for (const auto& [number, success] : result.cell(result.conditions.front(), model, level).score.*numbers)
      if (number >= first && number <= last)
        points += fmt::format("{:.1f},{:.1f} ", x_of(number, first, last), y_of((success.*part).fraction()));
    svg += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='2'/>\n", points, color);
    svg += fmt::format("<text x='{}' y='{}' fill='{}'>{}</text>\n", kWidth - 70,
                       40 + 16 * static_cast<int>(level), color, result.levels[level]);
  }
  return svg;
}

}  // namespace

std::vector<std::filesystem::path> write_figures(const ExperimentResult& result,
                                                 const std::filesystem::path& folder) {
  make_folder(folder);
  struct Figure {
    const char* name;
    const char* label;
    std::map<int, Success> Score::*numbers;
    int most;
  };
  const Figure figures[] = {{"objects", "number of objects (figure 6.5)", &Score::by_objects, 10},
                            {"actions", "number of actions (figure 6.8)", &Score::by_actions, 20}};
  const std::pair<const char*, Tally Success::*> parts[] = {{"association", &Success::association},
                                                            {"explanation", &Success::explanation}};
  std::vector<std::filesystem::path> files;
  for (const std::string& model : result.models) {
    if (model != "paper" && model != "shipped") continue;
    for (const Figure& figure : figures)
      for (const auto& [part, member] : parts) {
        const auto& numbers = result.cell(result.conditions.front(), model, 0).score.*figure.numbers;
        if (numbers.empty()) continue;
        const int first = numbers.begin()->first;
        const int last = std::max(first, std::min(figure.most, numbers.rbegin()->first));
        const std::string svg =
            fmt::format(
                "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
                "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' "
                "fill='white'/>\n",
                kWidth, kHeight) +
            axes(fmt::format("{}, {} model, {}", part, model, condition_name(result.conditions.front())),
                 figure.label, first, last) +
            lines(result, model, figure.numbers, member, first, last) + "</svg>\n";
        files.push_back(folder / fmt::format("{}_{}_{}.svg", model, part, figure.name));
        write_file_atomically(files.back(), svg);
      }
  }
  return files;
}

}  // namespace loci::apps::identity_experiment
