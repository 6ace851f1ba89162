#include "memory/belief/generative.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace loci::belief {
namespace {

constexpr double kSmallest = 1e-12;

/// Probability of at least one event.
double some(double rate, double time) {
  return -std::expm1(-rate * time);
}

}  // namespace

double mass(const Measured& number, const Domain& domain) {
  const double scale = 1 / std::sqrt(2 * number.variance);
  const double high = (domain.high - number.mean) * scale, low = (domain.low - number.mean) * scale;
  // Of two tails the difference is only exact where both are small.
  const double inside = low > 0 ? std::erfc(low) - std::erfc(high) : std::erfc(-high) - std::erfc(-low);
  return std::max(kSmallest, 0.5 * inside);
}

double log_same(const Measured& believed, const Domain& possible, const Measured& seen,
                const Domain& visible) {
  const double sum = believed.variance + seen.variance;
  const double difference = seen.mean - believed.mean;
  const Measured fused{(believed.mean * seen.variance + seen.mean * believed.variance) / sum,
                       believed.variance * seen.variance / sum};
  const double log_gaussian = -0.5 * (std::log(2 * std::numbers::pi * sum) + difference * difference / sum);
  return log_gaussian + std::log(mass(fused, visible) / (mass(believed, possible) * mass(seen, visible)));
}

Fates::Fates(const ChangeRates& rates, double gap)
    : removed_rate_(rates[Change::removed]),
      moved_rate_(rates[Change::moved]),
      returned_rate_(rates[Change::returned]),
      fading_rate_(rates[Change::removed] + rates[Change::changed]),
      gap_(gap),
      stays_(std::exp(-(fading_rate_ + moved_rate_) * gap)),
      changed_(std::exp(-(removed_rate_ + moved_rate_) * gap) * some(rates[Change::changed], gap)) {}

double Fates::moved(double window) const {
  return std::exp(-fading_rate_ * gap_) * some(moved_rate_, std::min(window, gap_));
}

double Fates::returned(double window) const {
  window = std::min(window, gap_);
  if (!(fading_rate_ > kSmallest)) return 0;
  // Gone by then as removed / fading · (1 - e^(-fading t)), back at some moment of the window, and since then
  // neither gone again nor changed.
  const double back = some(fading_rate_, window) / fading_rate_ - window * std::exp(-fading_rate_ * gap_);
  return std::max(0.0, returned_rate_ * removed_rate_ / fading_rate_ * back);
}

double untracked(double arrival_rate, double leaving, double time) {
  return arrival_rate * (leaving * time > 1e-9 ? some(leaving, time) / leaving : time);
}

NoiseEstimate::NoiseEstimate(double start_sigma)
    : start_variance_(start_sigma * start_sigma), squares_(2 * start_variance_), count_(2) {}

NoiseEstimate NoiseEstimate::known(double sigma) {
  NoiseEstimate estimate(sigma);
  estimate.known_ = true;
  return estimate;
}

void NoiseEstimate::count(double difference, double looks, double probability) {
  squares_ += probability * difference * difference / (1 + 1 / looks);
  count_ += probability;
}

}  // namespace loci::belief
