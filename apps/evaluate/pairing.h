#pragma once

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace loci::apps {

/// Numbers of what was known and what is seen that are taken for the same.
using Pairs = std::vector<std::pair<size_t, size_t>>;

/// Those who are each other's best, if value(o, k) is above `least` (RoboSherlock's
/// ObjectIdentityResolution). In order of what is seen; of equal values the first counts.
template <class Value>
Pairs mutual_best(size_t old_count, size_t seen_count, double least, const Value& value) {
  std::vector<size_t> best_seen(old_count, seen_count), best_old(seen_count, old_count);
  std::vector<double> most_of_seen(seen_count, least);
  for (size_t o = 0; o < old_count; ++o) {
    double most = 0;
    for (size_t k = 0; k < seen_count; ++k) {
      const double of_pair = value(o, k);
      if (of_pair > most) {
        most = of_pair;
        best_seen[o] = k;
      }
      if (of_pair > most_of_seen[k]) {
        most_of_seen[k] = of_pair;
        best_old[k] = o;
      }
    }
  }
  Pairs pairs;
  for (size_t k = 0; k < seen_count; ++k)
    if (best_old[k] < old_count && best_seen[best_old[k]] == k) pairs.emplace_back(best_old[k], k);
  return pairs;
}

/// The nearest first, each once, as long as distance(o, k) is at most `farthest`.
template <class Distance>
Pairs nearest_first(size_t old_count, size_t seen_count, double farthest, const Distance& distance) {
  std::vector<std::tuple<double, size_t, size_t>> candidates;
  for (size_t o = 0; o < old_count; ++o)
    for (size_t k = 0; k < seen_count; ++k)
      if (const double apart = distance(o, k); apart <= farthest) candidates.emplace_back(apart, o, k);
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> old_taken(old_count), seen_taken(seen_count);
  Pairs pairs;
  for (const auto& [apart, o, k] : candidates) {
    if (old_taken[o] || seen_taken[k]) continue;
    old_taken[o] = seen_taken[k] = true;
    pairs.emplace_back(o, k);
  }
  return pairs;
}

}  // namespace loci::apps
