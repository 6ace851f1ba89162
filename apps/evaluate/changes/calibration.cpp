#include "apps/evaluate/changes/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/text/html.h"

namespace loci::apps::changes {

std::vector<ReliabilityBin> reliability_bins(Stated stated) {
  if (stated.empty()) return {};
  std::ranges::sort(stated);
  std::vector<ReliabilityBin> bins(std::clamp<size_t>(stated.size() / 30, 1, 10));
  for (size_t k = 0; k < bins.size(); ++k) {
    ReliabilityBin& bin = bins[k];
    for (size_t i = k * stated.size() / bins.size(); i < (k + 1) * stated.size() / bins.size(); ++i) {
      ++bin.count;
      bin.stated += stated[i].first;
      bin.right += stated[i].second ? 1 : 0;
    }
    bin.stated /= static_cast<double>(bin.count);
    bin.right /= static_cast<double>(bin.count);
  }
  return bins;
}

double calibration_error(const Stated& stated) {
  double error = 0;
  for (const ReliabilityBin& bin : reliability_bins(stated))
    error += static_cast<double>(bin.count) * std::abs(bin.stated - bin.right);
  return error / std::max<double>(1, static_cast<double>(stated.size()));
}

double brier_score(const Stated& stated) {
  double sum = 0;
  for (const auto& [probability, so] : stated) sum += std::pow(probability - (so ? 1 : 0), 2);
  return sum / std::max<double>(1, static_cast<double>(stated.size()));
}

namespace {

constexpr double kSide = 220, kMargin = 45;  ///< of a panel, units of the drawing

/// Bounds of a share in 95 % of the cases [Wilson 1927].
std::pair<double, double> wilson_interval(double share, double count) {
  constexpr double z = 1.96;
  const double middle = (share + z * z / (2 * count)) / (1 + z * z / count);
  const double half =
      z / (1 + z * z / count) * std::sqrt(share * (1 - share) / count + z * z / (4 * count * count));
  return {middle - half, middle + half};
}

std::string panel(const std::string& kind, const Stated& stated, double left) {
  const auto x = [&](double probability) { return left + kSide * probability; };
  const auto y = [](double share) { return kMargin + kSide * (1 - share); };
  std::string out = fmt::format(
      "<rect x=\"{0:.0f}\" y=\"{1:.0f}\" width=\"{2:.0f}\" height=\"{2:.0f}\" fill=\"none\" "
      "stroke=\"#889\"/>\n"
      "<path d=\"M{0:.0f} {3:.0f}L{4:.0f} {1:.0f}\" stroke=\"#889\" stroke-dasharray=\"4 3\"/>\n"
      "<text x=\"{0:.0f}\" y=\"16\" font-weight=\"bold\">{5}</text>\n"
      "<text x=\"{0:.0f}\" y=\"34\">error {6:.3f}, Brier {7:.3f}, of {8}</text>\n"
      "<text x=\"{9:.0f}\" y=\"{10:.0f}\" text-anchor=\"middle\">stated (0 to 1)</text>\n",
      left, kMargin, kSide, kMargin + kSide, left + kSide, html_escape(kind), calibration_error(stated),
      brier_score(stated), stated.size(), x(0.5), kMargin + kSide + 18);
  for (const ReliabilityBin& bin : reliability_bins(stated)) {
    const auto [low, high] = wilson_interval(bin.right, static_cast<double>(bin.count));
    out += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#27c\" stroke-width=\"2\"/>"
        "<circle cx=\"{0:.1f}\" cy=\"{3:.1f}\" r=\"4\" fill=\"#27c\"><title>{4:.3f} stated, {5:.3f} right, "
        "of "
        "{6}</title></circle>\n",
        x(bin.stated), y(low), y(high), y(bin.right), bin.stated, bin.right, bin.count);
  }
  return out;
}

}  // namespace

std::string reliability_diagrams(const std::vector<std::pair<std::string, Stated>>& kinds) {
  std::string panels;
  double left = kMargin;
  for (const auto& [kind, stated] : kinds) {
    if (stated.empty()) continue;
    panels += panel(kind, stated, left);
    left += kSide + kMargin;
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"13\" role=\"img\" aria-label=\"reliability of "
      "stated "
      "probabilities\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#fff\"/>\n"
      "<text x=\"14\" y=\"{2:.0f}\" transform=\"rotate(-90 20 {2:.0f})\" text-anchor=\"middle\">right (0 to "
      "1)</text>\n{3}</svg>\n",
      left, kSide + 2 * kMargin, kMargin + kSide / 2, panels);
}

}  // namespace loci::apps::changes
