// The backward half of the forward-backward algorithm for two states, at the place and elsewhere. The stored
// belief is the forward half.

#include "memory/questions/smoothing.h"

#include <algorithm>

namespace loci::memory {
namespace {

/// The likelihood of what was seen later, given where the object was.
struct Likelihood {
  double there = 1, away = 1;
};

/// Something that was seen later: its likelihood, and how probable it was that the object had not left since
/// the evidence before.
struct Evidence {
  Likelihood likelihood = {};
  double stayed = 1;
};

/// Likelihoods of a look by which a probability changed.
Likelihood likelihood_of(double before, double after) {
  constexpr double kSure = 1e-6;  // a row of belief is not more certain
  const auto odds = [&](double p) {
    const double bounded = std::clamp(p, kSure, 1 - kSure);
    return bounded / (1 - bounded);
  };
  return {odds(after) / odds(before), 1};
}

/// The likelihood one step earlier. Who left comes back to the same place in the long run as often as
/// kBack, at the rate at which it leaves: a Markov chain.
Likelihood earlier(const Likelihood& later, double stayed) {
  constexpr double kBack = 0.2;
  const double there_there = kBack + (1 - kBack) * stayed, away_there = kBack * (1 - stayed);
  return {there_there * later.there + (1 - there_there) * later.away,
          away_there * later.there + (1 - away_there) * later.away};
}

/// What was seen of the object after a moment, up to the look that decides where it was.
std::vector<Evidence> evidence_after(const Store& store, const BeliefRow& then, TimeNs moment,
                                     const AsOf& known) {
  const std::optional<ObjectObservation> found =
      store.first_observation_after(then.object, moment, {}, known);
  const std::vector<BeliefRow> rows = store.belief_history(
      then.object, {found ? std::optional(found->time - 1) : std::nullopt, known.known_at}, moment);
  std::vector<Evidence> all;
  const BeliefRow* before = &then;
  TimeNs since = moment;
  const auto stayed_until = [&](TimeNs time) {
    const double believed = faded(*before, since);
    return believed > 0 ? std::clamp(faded(*before, time) / believed, 0.0, 1.0) : 1;
  };
  for (const BeliefRow& row : rows) {
    const TimeNs time = row.clock.valid_from;
    if (time <= moment) continue;
    all.push_back({likelihood_of(faded(*before, time), row.probability), stayed_until(time)});
    if (row.status == ObjectStatus::gone) return all;
    before = &row;
    since = time;
  }
  if (!found) return all;
  const bool same_place = found->observation.place == then.place;
  const double there = same_place ? found->association.probability : 0;
  all.push_back({{there, 1 - there}, stayed_until(found->time)});
  return all;
}

}  // namespace

double smoothed_probability(const Store& store, const BeliefRow& then, const AsOf& as_of) {
  const bool decided = then.status == ObjectStatus::seen || then.status == ObjectStatus::gone;
  if (!as_of.at || decided || !then.place || !then.fade_s) return then.probability;
  Likelihood likelihood;
  const std::vector<Evidence> later = evidence_after(store, then, *as_of.at, {.known_at = as_of.known_at});
  for (auto one = later.rbegin(); one != later.rend(); ++one)
    likelihood = earlier({likelihood.there * one->likelihood.there, likelihood.away * one->likelihood.away},
                         one->stayed);
  const double there = then.probability * likelihood.there, away = (1 - then.probability) * likelihood.away;
  return there + away > 0 ? there / (there + away) : then.probability;
}

}  // namespace loci::memory
