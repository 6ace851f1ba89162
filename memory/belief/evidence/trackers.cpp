#include "memory/belief/evidence/trackers.h"

#include <span>

#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

static_assert(2 * kParameters.max_tracker_distance[0] + kParameters.tracker_margin_m <=
              kParameters.tracker_reach_m + 1e-9);

/// Distances of one tracker.
struct Table {
  size_t rows, columns;
  std::span<const double> values;

  double at(size_t k, size_t o) const { return values[k * columns + o]; }

  /// Mutual nearest neighbour of an observation.
  std::optional<size_t> mutual(size_t k, double max_distance) const {
    size_t best = 0;
    for (size_t o = 1; o < columns; ++o)
      if (at(k, o) < at(k, best)) best = o;
    if (columns == 0 || !(at(k, best) <= max_distance)) return std::nullopt;
    for (size_t other = 0; other < rows; ++other)
      if (at(other, best) < at(k, best)) return std::nullopt;
    return best;
  }

  bool nothing_else_near(size_t k, size_t o) const {
    const double min_distance = 2 * at(k, o) + kParameters.tracker_margin_m;
    for (size_t other = 0; other < columns; ++other)
      if (other != o && at(k, other) < min_distance) return false;
    for (size_t other = 0; other < rows; ++other)
      if (other != k && at(other, o) < min_distance) return false;
    return true;
  }
};

}  // namespace

std::vector<TrackerVotes> votes(const TrackerDistances& distances) {
  const auto table = [&](size_t t) {
    return Table{distances.observations, distances.keys.size(), distances.of[t]};
  };
  std::vector<TrackerVotes> all(distances.observations);
  for (size_t k = 0; k < all.size(); ++k) {
    std::array<std::optional<size_t>, kTrackers.size()> proposed;
    for (size_t t = 0; t < kTrackers.size(); ++t) {
      proposed[t] = table(t).mutual(k, kParameters.max_tracker_distance[t]);
      if (proposed[t]) all[k].key[t] = distances.keys[*proposed[t]];
    }
    const bool agree = proposed[0] && proposed[1] == proposed[0] && proposed[2] == proposed[0];
    if (agree && table(0).nothing_else_near(k, *proposed[0])) all[k].settled = all[k].key[0];
  }
  return all;
}

}  // namespace loci::memory::belief
