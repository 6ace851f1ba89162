#include "memory/belief/whereabouts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loci::memory::belief {

Handling handling(const ChangeRates& rates, double attention) {
  const double removed = rates[Change::removed], moved = rates[Change::moved],
               changed = rates[Change::changed];
  const double sum = removed + moved + changed;
  // Those that were handled were not handled again: their number grows evenly, up to nearly all.
  constexpr double kMax = 0.95;
  const double share = sum > 0 ? std::min(attention, kMax / sum) : 0.0;
  return {share * removed, share * moved, share * changed,
          std::min(kMax, rates[Change::returned] * attention)};
}

double Untracked::sum() const {
  double sum = 0;
  for (size_t i = 0; i < arrived.size(); ++i) sum += at(i);
  return sum;
}

void predict(Whereabouts& object, const Handling& handling, size_t cells, Untracked& untracked) {
  const double cell_share = 1 / static_cast<double>(cells);
  const double untouched = handling.untouched();
  const double away = object.moved + object.returned;
  const double moves = (object.here + away) * handling.moved;
  const double returns = object.gone * handling.returned;
  const double changed_and_moved = object.changed * handling.moved * cell_share;
  if (object.elsewhere.empty()) object.elsewhere.assign(cells, 0.0);
  const double landed = (moves + returns) * cell_share;
  for (size_t i = 0; i < cells; ++i) {
    untracked.lost[i] += object.elsewhere[i] * handling.changed + changed_and_moved;
    object.elsewhere[i] = object.elsewhere[i] * untouched + landed;
  }
  object.gone += (object.here + away) * handling.removed - returns;
  object.moved = object.moved * untouched + moves;
  object.returned = object.returned * untouched + returns;
  object.changed = object.changed * (untouched + handling.changed) + object.here * handling.changed;
  object.here *= untouched;
}

void predict(Untracked& untracked, const Handling& handling, double arrivals) {
  const double stays = 1 - handling.removed - handling.moved;
  for (std::vector<double>* grid : {&untracked.arrived, &untracked.initial, &untracked.lost}) {
    const double sum = std::accumulate(grid->begin(), grid->end(), 0.0);
    const double landed = sum * handling.moved / static_cast<double>(grid->size());
    for (double& cell : *grid) cell = cell * stays + landed;
  }
  for (double& cell : untracked.arrived) cell += arrivals;
}

double not_seen(Whereabouts& object, double in_view, const std::vector<double>& seen) {
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

void looked_at(Untracked& untracked, const std::vector<double>& seen) {
  for (std::vector<double>* grid : {&untracked.arrived, &untracked.initial, &untracked.lost})
    for (size_t i = 0; i < grid->size(); ++i) (*grid)[i] *= 1 - seen[i];
}

}  // namespace loci::memory::belief
