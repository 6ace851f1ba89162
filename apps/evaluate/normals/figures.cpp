#include "apps/evaluate/normals/figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/base/text/html.h"

namespace loci::apps::normals_evaluation {
namespace {

constexpr double kWidth = 560, kHeight = 320, kLeft = 52, kRight = 16, kTop = 30, kBottom = 42;
constexpr double kShownDeg = 15;
constexpr const char* kColors[] = {"#b2182b", "#2166ac", "#1b7837", "#e08214", "#762a83"};

/// One line of an image.
struct Line {
  std::string label;
  const ErrorHistogram* errors;
};

double x_of(double degrees, double low, double high) {
  return kLeft + (degrees - low) / (high - low) * (kWidth - kLeft - kRight);
}

std::string frame(const std::string& title, const std::string& below, double low, double high, double step) {
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n"
      "<text x='{2}' y='18' font-weight='bold'>{3}</text>\n",
      kWidth, kHeight, kLeft, html_escape(title));
  for (double tick = low; tick <= high + 1e-9; tick += step)
    svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{:g}°</text>\n", x_of(tick, low, high),
                       kHeight - kBottom + 16, tick);
  return svg + fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{}</text>\n",
                           (kLeft + kWidth - kRight) / 2, kHeight - 8, html_escape(below));
}

/// Histograms of errors in steps of half a degree, as shares of all normals.
std::string histograms(const std::string& title, const std::vector<Line>& lines) {
  constexpr double kStep = 0.5;
  double most = 0.05;
  const auto share = [](const ErrorHistogram& errors, double from) {
    return errors.within(from + kStep) - errors.within(from);
  };
  for (const Line& line : lines)
    for (double from = 0; from < kShownDeg; from += kStep) most = std::max(most, share(*line.errors, from));
  const auto y_of = [most](double value) {
    return kHeight - kBottom - value / most * (kHeight - kBottom - kTop);
  };
  std::string svg = frame(title, "angular error", 0, kShownDeg, 1);
  for (double tick = 0; tick <= most; tick += most > 0.5 ? 0.2 : most > 0.2 ? 0.1 : 0.02)
    svg += fmt::format(
        "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' "
        "text-anchor='end'>{5:.0f} %</text>\n",
        kLeft, kWidth - kRight, y_of(tick), kLeft - 4, y_of(tick) + 4, 100 * tick);
  for (size_t i = 0; i < lines.size(); ++i) {
    const char* color = kColors[i % std::size(kColors)];
    std::string points;
    for (double from = 0; from < kShownDeg; from += kStep)
      for (const double end : {from, from + kStep})
        points += fmt::format("{:.1f},{:.1f} ", x_of(end, 0, kShownDeg), y_of(share(*lines[i].errors, from)));
    svg += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='1.6'/>\n", points, color);
    svg += fmt::format("<text x='{}' y='{}' fill='{}' text-anchor='end'>{}</text>\n", kWidth - kRight - 4,
                       kTop + 14 + 15 * static_cast<double>(i), color, html_escape(lines[i].label));
  }
  return svg + "</svg>\n";
}

/// Deviation over inclination: darker where there are more, each row by its own maximum.
std::string deviations(const std::string& title, const InclinationHistogram& histogram) {
  using H = InclinationHistogram;
  constexpr double kReach = H::kReachDeg;
  const double height = (kHeight - kTop - kBottom) / H::kRows;
  const double width = (kWidth - kLeft - kRight) / H::kColumns;
  std::string svg =
      frame(title, "deviation of the inclination (left: too flat, right: too steep)", -kReach, kReach, 2);
  for (int row = 0; row < H::kRows; ++row) {
    const auto shares = histogram.row(row);
    const double y = kHeight - kBottom - (row + 1) * height;
    for (int column = 0; column < H::kColumns; ++column) {
      const double share = shares[static_cast<size_t>(column)];
      if (share < 0.02) continue;
      svg += fmt::format(
          "<rect x='{:.1f}' y='{:.1f}' width='{:.2f}' height='{:.2f}' fill='#2166ac' "
          "fill-opacity='{:.2f}'/>\n",
          kLeft + column * width, y, width, height, share);
    }
    if (row % 2 == 0)
      svg += fmt::format("<text x='{}' y='{:.1f}' text-anchor='end'>{:g}°</text>\n", kLeft - 4,
                         y + height + 4, row * H::kRowDeg);
  }
  return svg + fmt::format(
                   "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#888' "
                   "stroke-dasharray='3 3'/>\n</svg>\n",
                   x_of(0, -kReach, kReach), kTop, kHeight - kBottom);
}

/// Lines of our method against truth and reference, as in figures 4.2 and 4.6.
std::vector<Line> truth_and_reference(const MethodErrors& errors) {
  std::vector<Line> lines = {{"against the truth", &errors.to_truth}};
  if (errors.to_reference.count() > 0)
    lines.push_back({std::string("against ") + kReference, &errors.to_reference});
  return lines;
}

}  // namespace

std::vector<std::filesystem::path> write_figures(const Comparison& comparison,
                                                 const std::filesystem::path& folder) {
  make_folder(folder);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const std::string& name, const std::string& svg) {
    files.push_back(folder / (name + ".svg"));
    write_file_atomically(files.back(), svg);
  };
  const SetResult& quiet = comparison.sets.front();
  const MethodErrors& before = *quiet.find(kBefore);
  const MethodErrors& after = *quiet.find(kAfter);
  write("fig_4_2_errors_before",
        histograms("Errors before the correction (figure 4.2)", truth_and_reference(before)));
  write("fig_4_6_errors_after",
        histograms("Errors after the correction (figure 4.6)", truth_and_reference(after)));
  write("fig_4_4_deviation_before",
        deviations("Deviation by inclination before the correction (figure 4.4)", before.by_inclination));
  write("fig_4_5_deviation_after",
        deviations("Deviation by inclination after the correction (figure 4.5)", after.by_inclination));
  std::vector<Line> levels;
  for (const SetResult& set : comparison.sets) {
    if (set.synthetic) levels.push_back({set.name, &set.find(kAfter)->to_truth});
    std::vector<Line> methods;
    for (const auto& [name, errors] : set.methods)
      if (errors.to_truth.count() > 0 && name != kBefore) methods.push_back({name, &errors.to_truth});
    std::string file = set.name;
    std::replace_if(
        file.begin(), file.end(), [](char c) { return c == ' ' || c == ',' || c == '/'; }, '_');
    write("methods_" + file, histograms("Errors of all methods: " + set.name, methods));
  }
  write("fig_4_3_noise", histograms("Errors by disparity noise (figure 4.3)", levels));
  return files;
}

}  // namespace loci::apps::normals_evaluation
