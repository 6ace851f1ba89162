#include "memory/belief/calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loci::memory::belief {
namespace {

constexpr size_t kBins = Correction::kBins;
/// Finer where what is the same lies; distances are about 1 at most.
constexpr std::array<double, kBins - 1> kBorders{0.02, 0.04, 0.07, 0.11, 0.16, 0.22,
                                                 0.30, 0.40, 0.52, 0.66, 0.82};
/// Distances that the tables of comparisons() are worth.
constexpr double kPrior = 30;
/// Evidence beyond this makes older evidence fade.
constexpr float kMax = 10000;

size_t bin_of(double distance) {
  return static_cast<size_t>(std::ranges::upper_bound(kBorders, distance) - kBorders.begin());
}

double middle(size_t bin) {
  const double low = bin == 0 ? 0.0 : kBorders[bin - 1];
  const double high = bin == kBorders.size() ? 1.0 : kBorders[bin];
  return (low + high) / 2;
}

using Shares = std::array<double, kBins>;

/// How distances are spread, before anything was seen, between looks at the same thing and at different
/// ones.
struct Spread {
  Shares same{}, different{};
};

/// The most even spread whose ratio is what the comparison's table says: q ~ exp(-s t), p ~ exp((1-s) t),
/// with s such that both have the same sum.
Spread spread_of(const Shares& table) {
  double low = 0, high = 1;
  const auto sum = [&](double exponent) {
    double all = 0;
    for (const double ratio : table) all += std::exp(exponent * ratio);
    return all;
  };
  for (int i = 0; i < 40; ++i) {
    const double s = (low + high) / 2;
    (sum(1 - s) > sum(-s) ? low : high) = s;
  }
  const double all = sum(-low);
  Spread spread;
  for (size_t i = 0; i < kBins; ++i) {
    spread.different[i] = std::exp(-low * table[i]) / all;
    spread.same[i] = spread.different[i] * std::exp(table[i]);
  }
  return spread;
}

using PriorSpreads = std::array<std::array<Spread, 2>, kComparisons>;

PriorSpreads prior_spreads() {
  PriorSpreads all;
  for (size_t kind = 0; kind < kComparisons; ++kind) {
    for (const bool colorless : {false, true}) {
      Shares table{};
      for (size_t i = 0; i < kBins; ++i)
        table[i] = prior_log_ratio(comparisons()[kind], middle(i), colorless);
      all[kind][colorless] = spread_of(table);
    }
  }
  return all;
}

/// Log of how much more or less of the distances lie in each bin than was expected.
Shares surprise(const std::array<float, kBins>& counts, const Shares& expected) {
  const double all = std::accumulate(counts.begin(), counts.end(), kPrior);
  Shares result{};
  for (size_t i = 0; i < kBins; ++i)
    result[i] = std::log((counts[i] + kPrior * expected[i]) / (all * expected[i]));
  return result;
}

std::string key_of(size_t kind, bool colorless) {
  const Comparison& comparison = comparisons()[kind];
  return comparison.kind + (colorless && comparison.of_color ? ", no color" : "");
}

}  // namespace

double prior_log_ratio(const Comparison& comparison, double distance, bool colorless) {
  const double ratio = log_ratio(comparison, distance);
  return colorless && comparison.of_color && ratio > 0 ? ratio / 2 : ratio;
}

double Correction::at(double distance) const {
  if (!(distance > middle(0))) return values.front();
  for (size_t i = 1; i < values.size(); ++i) {
    if (distance > middle(i)) continue;
    const double t = (distance - middle(i - 1)) / (middle(i) - middle(i - 1));
    return values[i - 1] + t * (values[i] - values[i - 1]);
  }
  return values.back();
}

void Calibration::Counts::count(bool same, double distance, double weight) {
  (same ? same_ : different_)[bin_of(distance)] += static_cast<float>(weight);
}

void Calibration::Counts::fade() {
  for (auto* counts : {&same_, &different_})
    if (std::accumulate(counts->begin(), counts->end(), 0.0F) > kMax)
      for (float& count : *counts) count /= 2;
}

Calibration::Counts& Calibration::of(size_t kind, bool colorless) {
  return counts_[key_of(kind, colorless)];
}

Corrections Calibration::corrections() const {
  static const PriorSpreads prior = prior_spreads();
  Corrections all{};
  for (size_t kind = 0; kind < kComparisons; ++kind) {
    for (const bool colorless : {false, true}) {
      const auto found = counts_.find(key_of(kind, colorless));
      if (found == counts_.end()) continue;
      const Shares same = surprise(found->second.same_, prior[kind][colorless].same);
      const Shares different = surprise(found->second.different_, prior[kind][colorless].different);
      for (size_t i = 0; i < kBins; ++i) all[kind][colorless].values[i] = same[i] - different[i];
    }
  }
  return all;
}

}  // namespace loci::memory::belief
