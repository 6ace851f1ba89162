#include "memory/belief/rates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loci::memory::belief {
namespace {

constexpr std::array<double, 5> kFactors{0.3, 0.65, 1.0, 1.4, 2.0};

}  // namespace

ChangeRates ChangeRates::times(double factor) const {
  ChangeRates result = *this;
  for (size_t i = 0; i < kChanges; ++i)
    if (static_cast<Change>(i) != Change::initial) result.of[i] *= factor;
  return result;
}

ChangeRates RateLearner::rates() const {
  ChangeRates rates;
  for (size_t i = 0; i < kChanges; ++i)
    rates.of[i] = (kPriorEvents + events_[i]) / (kPriorEvents / prior_.of[i] + exposure_[i]);
  return rates;
}

void RateLearner::count(Change change, double found, double expected, double weight) {
  Sums& sums = scene_[static_cast<size_t>(change)];
  sums.found += weight * found;
  sums.expected += weight * expected;
  sums.doubt_before += weight * expected * (1 - expected);
  sums.doubt_after += weight * found * (1 - found);
}

void RateLearner::expect(Change change, double expected, double weight) {
  Sums& sums = scene_[static_cast<size_t>(change)];
  sums.expected += weight * expected;
  sums.doubt_before += weight * expected;
}

void RateLearner::find(Change change, double probability, double weight) {
  Sums& sums = scene_[static_cast<size_t>(change)];
  sums.found += weight * probability;
  sums.doubt_after += weight * probability * (1 - probability);
}

void RateLearner::finish_scene() {
  const ChangeRates now = rates();
  const double keep = std::exp(-1 / kMemoryScenes);
  for (size_t i = 0; i < kChanges; ++i) {
    const Sums& sums = scene_[i];
    const double told =
        sums.doubt_before > 0 ? std::clamp(1 - sums.doubt_after / sums.doubt_before, 0.0, 1.0) : 0.0;
    // A step from what was expected towards what was found, with the weight of what was told.
    const double events = sums.found - (1 - told) * sums.expected;
    events_[i] = std::max(kMinEvents - kPriorEvents, keep * events_[i] + events);
    exposure_[i] = keep * exposure_[i] + told * sums.expected / now.of[i];
  }
  scene_ = {};
}

Busyness::Busyness() : common_(kFactors.size(), 1.0) {
  begin_world();
}

double Busyness::factor(size_t level) const {
  return kFactors[level];
}

void Busyness::begin_world() {
  if (observed_)
    for (size_t i = 0; i < common_.size(); ++i) common_[i] += weight_[i];
  observed_ = false;
  const double sum = std::accumulate(common_.begin(), common_.end(), 0.0);
  weight_ = common_;
  for (double& weight : weight_) weight /= sum;
}

void Busyness::observe(const std::vector<double>& log_evidence) {
  observed_ = true;
  const double largest = *std::max_element(log_evidence.begin(), log_evidence.end());
  double sum = 0;
  for (size_t i = 0; i < weight_.size(); ++i) sum += weight_[i] *= std::exp(log_evidence[i] - largest);
  for (double& weight : weight_) weight /= sum;
}

}  // namespace loci::memory::belief
