#include "memory/belief/evidence/calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "memory/belief/evidence/scale_prior.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

constexpr size_t kBins = Correction::kBins;
/// Finer where distances between views of one object lie; distances are about 1 at most.
constexpr std::array<double, kBins - 1> kBorders{0.02, 0.04, 0.07, 0.11, 0.16, 0.22,
                                                 0.30, 0.40, 0.52, 0.66, 0.82};

size_t bin_of(double distance) {
  return static_cast<size_t>(std::ranges::upper_bound(kBorders, distance) - kBorders.begin());
}

double middle(size_t bin) {
  const double low = bin == 0 ? 0.0 : kBorders[bin - 1];
  const double high = bin == kBorders.size() ? 1.0 : kBorders[bin];
  return (low + high) / 2;
}

using Shares = std::array<double, kBins>;

/// Prior distributions of the distance between views of one object and of different ones.
struct DistanceDistributions {
  Shares same{}, different{};
};

/// The most even distributions whose ratio is the comparison's table: q ~ exp(-s t), p ~ exp((1-s) t), with s
/// such that both have the same sum.
DistanceDistributions distributions_of(const Shares& table) {
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
  DistanceDistributions prior;
  for (size_t i = 0; i < kBins; ++i) {
    prior.different[i] = std::exp(-low * table[i]) / all;
    prior.same[i] = prior.different[i] * std::exp(table[i]);
  }
  return prior;
}

using PriorDistributions = std::array<std::array<DistanceDistributions, 2>, kComparisons>;

PriorDistributions prior_distributions() {
  PriorDistributions all;
  for (size_t kind = 0; kind < kComparisons; ++kind) {
    for (const bool achromatic : {false, true}) {
      Shares table{};
      for (size_t i = 0; i < kBins; ++i)
        table[i] = prior_log_ratio(comparisons()[kind], middle(i), achromatic);
      all[kind][achromatic] = distributions_of(table);
    }
  }
  return all;
}

/// Factors by which distances between views of one object may exceed what the tables expect: noise and light
/// differ between sensors and rooms.
constexpr std::array<double, 9> kScales{0.35, 0.5, 0.7, 1, 1.4, 2, 2.8, 4, 5.6};

using Scales = std::array<double, kScales.size()>;

/// A distribution of distances stretched by a factor; what exceeds the last bin falls into it.
Shares stretched(const Shares& shares, double scale) {
  constexpr size_t kSteps = 32;
  Shares result{};
  for (size_t i = 0; i < kBins; ++i) {
    const double low = i == 0 ? 0.0 : kBorders[i - 1], high = i == kBorders.size() ? 1.0 : kBorders[i];
    for (size_t step = 0; step < kSteps; ++step) {
      const double distance = low + (high - low) * (double(step) + 0.5) / double(kSteps);
      result[bin_of(scale * distance)] += shares[i] / double(kSteps);
    }
  }
  return result;
}

/// Distances between views of one object: a mixture of the expected distribution over scales.
class SameDistances {
 public:
  explicit SameDistances(const Shares& expected) : expected_(expected) {
    for (size_t s = 0; s < kScales.size(); ++s) of_scale_[s] = stretched(expected, kScales[s]);
    before_ = mixture(prior_);
  }

  /// Log ratio of the share in each bin, after `counts` were found, to the expected one.
  Shares log_found_over_expected(const std::array<float, kBins>& counts) const {
    const Shares now = mixture(fitted(counts));
    Shares scaled{};
    for (size_t i = 0; i < kBins; ++i) scaled[i] = expected_[i] * now[i] / before_[i];
    const double sum = std::accumulate(scaled.begin(), scaled.end(), 0.0);
    constexpr double kPrior = kParameters.calibration_prior;
    const double all = std::accumulate(counts.begin(), counts.end(), kPrior);
    Shares result{};
    for (size_t i = 0; i < kBins; ++i)
      result[i] = std::log((counts[i] + kPrior * scaled[i] / sum) / (all * expected_[i]));
    return result;
  }

 private:
  Shares mixture(const Scales& weights) const {
    Shares shares{};
    for (size_t s = 0; s < kScales.size(); ++s)
      for (size_t i = 0; i < kBins; ++i) shares[i] += weights[s] * (of_scale_[s][i] + 1e-6);
    return shares;
  }

  /// Maximum a posteriori by expectation maximisation.
  Scales fitted(const std::array<float, kBins>& counts) const {
    constexpr double kPrior = kParameters.calibration_prior;
    constexpr int kIterations = 8;
    const double all = std::accumulate(counts.begin(), counts.end(), kPrior);
    Scales weights = prior_;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Shares found = mixture(weights);  // over expected
      for (size_t i = 0; i < kBins; ++i) found[i] = counts[i] / (found[i] * all);
      Scales next{};
      for (size_t s = 0; s < kScales.size(); ++s) {
        next[s] = kPrior * prior_[s] / all;
        for (size_t i = 0; i < kBins; ++i) next[s] += found[i] * weights[s] * (of_scale_[s][i] + 1e-6);
      }
      weights = next;
    }
    return weights;
  }

  Shares expected_;
  Scales prior_ = scale_prior(kScales, kParameters.calibration_spread);
  std::array<Shares, kScales.size()> of_scale_{};
  Shares before_{};  ///< mixture of the prior scales
};

std::vector<SameDistances> same_distances(const PriorDistributions& prior) {
  std::vector<SameDistances> all;
  for (const auto& of_kind : prior)
    for (const DistanceDistributions& distributions : of_kind) all.emplace_back(distributions.same);
  return all;
}

/// Log ratio of the found to the expected share of distances in each bin.
Shares log_found_over_expected(const std::array<float, kBins>& counts, const Shares& expected) {
  const double all = std::accumulate(counts.begin(), counts.end(), kParameters.calibration_prior);
  Shares result{};
  for (size_t i = 0; i < kBins; ++i)
    result[i] = std::log((counts[i] + kParameters.calibration_prior * expected[i]) / (all * expected[i]));
  return result;
}

std::string key_of(size_t kind, bool achromatic) {
  const Comparison& comparison = comparisons()[kind];
  return comparison.kind + (achromatic && comparison.of_color ? ", achromatic" : "");
}

}  // namespace

double prior_log_ratio(const Comparison& comparison, double distance, bool achromatic) {
  const double ratio = log_ratio(comparison, distance);
  return achromatic && comparison.of_color && ratio > 0 ? ratio / 2 : ratio;
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

void Calibration::Counts::count(bool same_object, double distance, double weight) {
  (same_object ? same : different)[bin_of(distance)] += static_cast<float>(weight);
}

void Calibration::Counts::fade() {
  for (auto* counts : {&same, &different})
    if (std::accumulate(counts->begin(), counts->end(), 0.0F) > kParameters.calibration_max)
      for (float& count : *counts) count /= 2;
}

Calibration::Counts& Calibration::of(size_t kind, bool achromatic) {
  return counts_[key_of(kind, achromatic)];
}

void Calibration::count_color(double distance, double probability) {
  NoiseScale::Levels density{};
  for (size_t i = 0; i < NoiseScale::kLevels; ++i) {
    const double variance = kColorVariance * NoiseScale::kFactors[i] * NoiseScale::kFactors[i];
    density[i] = std::exp(-1.5 * distance * distance / variance) / std::pow(variance, 1.5);
  }
  color_noise_.count(density, probability, kParameters.calibration_spread);
}

Corrections Calibration::corrections() const {
  static const PriorDistributions prior = prior_distributions();
  static const std::vector<SameDistances> same_of = same_distances(prior);
  Corrections all{};
  all.color_noise = color_noise_.main_weights(kParameters.calibration_spread);
  for (size_t kind = 0; kind < kComparisons; ++kind) {
    if (kind == kMeanColor) continue;
    for (const bool achromatic : {false, true}) {
      const auto found = counts_.find(key_of(kind, achromatic));
      if (found == counts_.end()) continue;
      const Shares same =
          same_of[2 * kind + (achromatic ? 1 : 0)].log_found_over_expected(found->second.same);
      const Shares different =
          log_found_over_expected(found->second.different, prior[kind][achromatic].different);
      for (size_t i = 0; i < kBins; ++i) all.of[kind][achromatic].values[i] = same[i] - different[i];
    }
  }
  return all;
}

}  // namespace loci::memory::belief
