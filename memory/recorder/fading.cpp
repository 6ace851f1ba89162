#include "memory/recorder/fading.h"

#include <algorithm>
#include <cmath>

namespace loci::memory {
namespace {

/// What is seen again soon hardly fades in between, whatever comes later: so much of the loss is told
/// exactly.
constexpr double kFirstLoss = 0.05;

}  // namespace

Fading fading_of(const belief::ProtoObject& object, const belief::BeliefState& state,
                 const belief::BeliefOptions& options) {
  const belief::InteractionKey key = belief::interaction_key(object);
  const double age = state.exposure_s - object.last_seen_exposure_s;
  const auto left = [&](double seconds) {
    return 1 - state.interaction.probability(key, age, age + seconds, options);
  };
  double early = 0, late = 6 * options.move_time_s;
  Fading fading{options.move_time_s, left(late)};
  if (fading.share > 0.999) return fading;  // hardly at all
  const double level = std::max(1 - kFirstLoss, (1 + fading.share) / 2);
  while (late - early > 0.01 * late) {
    const double middle = (early + late) / 2;
    (left(middle) > level ? early : late) = middle;
  }
  fading.time_s = -late / std::log((level - fading.share) / (1 - fading.share));
  return fading;
}

}  // namespace loci::memory
