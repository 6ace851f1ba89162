#include "mapping/interpretation/edge_position.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "mapping/base/quantile.h"

namespace loci::mapping {
namespace {

/// The slab's vertical edge where it was seen: the peak of the points right below the top.
std::optional<double> rim_position(std::vector<double> rim, double length) {
  constexpr double kBin = 0.005;
  constexpr double kHalf = 0.012;       // m; half width of the peak
  constexpr double kPerMetre = 60;      // points that make a peak
  constexpr double kAboveOthers = 2.5;  // times as dense as the rest
  std::sort(rim.begin(), rim.end());
  size_t most = 0;
  double peak = 0;
  for (double at = -kEdgeWindow; at < kEdgeWindow; at += kBin) {
    const auto count = static_cast<size_t>(std::upper_bound(rim.begin(), rim.end(), at + kHalf) -
                                           std::lower_bound(rim.begin(), rim.end(), at - kHalf));
    if (count <= most) continue;
    most = count;
    peak = at;
  }
  const double density = static_cast<double>(most) / (2 * kHalf);
  const double others = static_cast<double>(rim.size() - most) / (2 * (kEdgeWindow - kHalf));
  if (static_cast<double>(most) < kPerMetre * length || density < kAboveOthers * others) return std::nullopt;
  return median(std::vector<double>(std::lower_bound(rim.begin(), rim.end(), peak - kHalf),
                                    std::upper_bound(rim.begin(), rim.end(), peak + kHalf)));
}

/// The line that parts surface from rays that passed beside it.
std::optional<double> parting_position(const EdgeSamples& samples, double length) {
  constexpr double kStep = 0.0025;
  constexpr double kPerMetre = 40;  // samples of each kind that say where the line is
  const auto enough = [&](const std::vector<double>& list) {
    return static_cast<double>(list.size()) > kPerMetre * length;
  };
  if (!enough(samples.support) || !enough(samples.passed)) return std::nullopt;
  size_t fewest = SIZE_MAX;
  std::vector<double> best;
  for (double at = -kEdgeWindow; at <= kEdgeWindow; at += kStep) {
    const auto errors = static_cast<size_t>(
        std::count_if(samples.support.begin(), samples.support.end(), [&](double v) { return v > at; }) +
        std::count_if(samples.passed.begin(), samples.passed.end(), [&](double v) { return v < at; }));
    if (errors < fewest) best.clear();
    if (errors <= fewest) best.push_back(at);
    fewest = std::min(fewest, errors);
  }
  if (10 * fewest > samples.support.size() + samples.passed.size()) return std::nullopt;
  return median(best);
}

/// Whether the top itself was seen in the strip by which an edge would grow, about as densely as inside it.
bool surface_reaches(const EdgeSamples& samples, double position) {
  constexpr double kNoMatter = 0.01;  // m
  constexpr double kDense = 0.4;      // of the density inside
  if (position < kNoMatter) return true;
  const auto between = [&](double low, double high) {
    const auto inside = [&](double v) { return v >= low && v < high; };
    return static_cast<double>(std::ranges::count_if(samples.support, inside) +
                               std::ranges::count_if(samples.brink, inside));
  };
  return between(0, position) / position >= kDense * between(-kEdgeWindow, 0) / kEdgeWindow;
}

}  // namespace

std::optional<double> edge_position(const EdgeSamples& samples, double length) {
  auto position = rim_position(samples.rim, length);
  if (!position) position = parting_position(samples, length);
  return position && surface_reaches(samples, *position) ? position : std::nullopt;
}

}  // namespace loci::mapping
