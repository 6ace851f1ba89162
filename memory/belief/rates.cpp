#include "memory/belief/rates.h"

#include <cmath>

namespace loci::belief {

RateLearner::RateLearner(const ChangeRates& prior) : prior_(prior) {}

void RateLearner::begin_world() {
  busy_events_ = 0;
  busy_expected_ = 0;
}

ChangeRates RateLearner::rates() const {
  ChangeRates rates;
  for (size_t i = 0; i < kChanges; ++i) {
    rates.of[i] = (kPriorEvents + events_[i]) / (kPriorEvents / prior_.of[i] + exposure_[i]);
    if (static_cast<Change>(i) != Change::initial) rates.of[i] *= busyness();
  }
  return rates;
}

void RateLearner::count(Change change, double events, double expected) {
  scene_events_[static_cast<size_t>(change)] += events;
  scene_expected_[static_cast<size_t>(change)] += expected;
}

void RateLearner::finish_scene() {
  const ChangeRates now = rates();
  const double busy = busyness();
  const double keep = std::exp(-1 / kMemoryScenes);
  for (size_t i = 0; i < kChanges; ++i) {
    const bool busy_counts = static_cast<Change>(i) != Change::initial;
    const double general = now.of[i] / (busy_counts ? busy : 1.0);
    events_[i] = keep * events_[i] + scene_events_[i];
    exposure_[i] = keep * exposure_[i] + scene_expected_[i] / general;
    if (!busy_counts) continue;
    busy_events_ += scene_events_[i];
    busy_expected_ += scene_expected_[i] / busy;
  }
  scene_events_ = {};
  scene_expected_ = {};
}

}  // namespace loci::belief
