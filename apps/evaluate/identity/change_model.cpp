#include "apps/evaluate/identity/change_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loci::apps::identity_experiment {
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
  sums.prior_variance += weight * expected * (1 - expected);
  sums.posterior_variance += weight * found * (1 - found);
}

void RateLearner::expect(Change change, double expected, double weight) {
  Sums& sums = scene_[static_cast<size_t>(change)];
  sums.expected += weight * expected;
  sums.prior_variance += weight * expected;
}

void RateLearner::find(Change change, double probability, double weight) {
  Sums& sums = scene_[static_cast<size_t>(change)];
  sums.found += weight * probability;
  sums.posterior_variance += weight * probability * (1 - probability);
}

void RateLearner::finish_scene() {
  const ChangeRates now = rates();
  const double keep = std::exp(-1 / kMemoryScenes);
  for (size_t i = 0; i < kChanges; ++i) {
    const Sums& sums = scene_[i];
    const double information = sums.prior_variance > 0
                                   ? std::clamp(1 - sums.posterior_variance / sums.prior_variance, 0.0, 1.0)
                                   : 0.0;
    // A step from the expectation towards the finding, weighted by the information of the scene.
    const double events = sums.found - (1 - information) * sums.expected;
    events_[i] = std::max(kMinEvents - kPriorEvents, keep * events_[i] + events);
    exposure_[i] = keep * exposure_[i] + information * sums.expected / now.of[i];
  }
  scene_ = {};
}

ActivityLevel::ActivityLevel() : common_(kFactors.size(), 1.0) {
  begin_world();
}

double ActivityLevel::factor(size_t level) const {
  return kFactors[level];
}

void ActivityLevel::begin_world() {
  if (observed_)
    for (size_t i = 0; i < common_.size(); ++i) common_[i] += weight_[i];
  observed_ = false;
  const double sum = std::accumulate(common_.begin(), common_.end(), 0.0);
  weight_ = common_;
  for (double& weight : weight_) weight /= sum;
}

void ActivityLevel::observe(const std::vector<double>& log_evidence) {
  observed_ = true;
  const double largest = *std::max_element(log_evidence.begin(), log_evidence.end());
  double sum = 0;
  for (size_t i = 0; i < weight_.size(); ++i) sum += weight_[i] *= std::exp(log_evidence[i] - largest);
  for (double& weight : weight_) weight /= sum;
}

Interactions interactions(const ChangeRates& rates, double exposure) {
  const double removed = rates[Change::removed], moved = rates[Change::moved],
               changed = rates[Change::changed];
  const double sum = removed + moved + changed;
  // No object is handled twice: the share grows linearly, up to nearly all.
  constexpr double kMax = 0.95;
  const double share = sum > 0 ? std::min(exposure, kMax / sum) : 0.0;
  return {share * removed, share * moved, share * changed,
          std::min(kMax, rates[Change::returned] * exposure)};
}

double UndetectedIntensity::sum() const {
  double sum = 0;
  for (size_t i = 0; i < arrived.size(); ++i) sum += at(i);
  return sum;
}

void predict(LocationBelief& object, const Interactions& interactions, size_t cells,
             UndetectedIntensity& undetected) {
  const double cell_share = 1 / static_cast<double>(cells);
  const double untouched = interactions.untouched();
  const double away = object.moved + object.returned;
  const double moves = (object.here + away) * interactions.moved;
  const double returns = object.gone * interactions.returned;
  const double changed_and_moved = object.changed * interactions.moved * cell_share;
  if (object.elsewhere.empty()) object.elsewhere.assign(cells, 0.0);
  const double landed = (moves + returns) * cell_share;
  for (size_t i = 0; i < cells; ++i) {
    undetected.lost[i] += object.elsewhere[i] * interactions.changed + changed_and_moved;
    object.elsewhere[i] = object.elsewhere[i] * untouched + landed;
  }
  object.gone += (object.here + away) * interactions.removed - returns;
  object.moved = object.moved * untouched + moves;
  object.returned = object.returned * untouched + returns;
  object.changed = object.changed * (untouched + interactions.changed) + object.here * interactions.changed;
  object.here *= untouched;
}

void predict(UndetectedIntensity& undetected, const Interactions& interactions, double arrivals) {
  const double stays = 1 - interactions.removed - interactions.moved;
  for (std::vector<double>* grid : {&undetected.arrived, &undetected.initial, &undetected.lost}) {
    const double sum = std::accumulate(grid->begin(), grid->end(), 0.0);
    const double landed = sum * interactions.moved / static_cast<double>(grid->size());
    for (double& cell : *grid) cell = cell * stays + landed;
  }
  for (double& cell : undetected.arrived) cell += arrivals;
}

double observe_absence(LocationBelief& object, double in_view, const std::vector<double>& seen) {
  double before = 0, after = 0;
  for (size_t i = 0; i < object.elsewhere.size(); ++i) {
    before += object.elsewhere[i];
    object.elsewhere[i] *= 1 - seen[i];
    after += object.elsewhere[i];
  }
  const double unseen = (1 - in_view) * (object.here + object.changed);
  const double probability = std::max(1e-9, 1 - (object.here + object.changed - unseen) - (before - after));
  const double away = before > 0 ? after / before / probability : 0.0;
  object.here *= (1 - in_view) / probability;
  object.changed *= (1 - in_view) / probability;
  object.gone /= probability;
  object.moved *= away;
  object.returned *= away;
  for (double& cell : object.elsewhere) cell /= probability;
  return probability;
}

void observe(UndetectedIntensity& undetected, const std::vector<double>& seen) {
  for (std::vector<double>* grid : {&undetected.arrived, &undetected.initial, &undetected.lost})
    for (size_t i = 0; i < grid->size(); ++i) (*grid)[i] *= 1 - seen[i];
}

NoiseEstimate::NoiseEstimate(double start_sigma) : squares_(2 * start_sigma * start_sigma), count_(2) {}

NoiseEstimate NoiseEstimate::known(double sigma) {
  NoiseEstimate estimate(sigma);
  estimate.known_ = true;
  return estimate;
}

void NoiseEstimate::count(double difference, double views, double probability) {
  if (known_) return;
  const double keep = 1 - probability / kMemory;
  squares_ = keep * squares_ + probability * difference * difference / (1 + 1 / views);
  count_ = keep * count_ + probability;
}

}  // namespace loci::apps::identity_experiment
