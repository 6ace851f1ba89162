#include "apps/evaluate/system/scene_counts.h"

#include <algorithm>
#include <cstdlib>

#include "mapping/base/error.h"
#include "mapping/base/math/shuffle.h"

namespace loci::apps::system_evaluation {
namespace {

std::vector<int> values_of(const Histogram& histogram) {
  std::vector<int> values;
  for (const auto& [value, count] : histogram) values.insert(values.end(), static_cast<size_t>(count), value);
  return values;
}

/// How far the totals are from the published ones.
int distance(const Histogram& totals) {
  int sum = 0;
  for (const auto& [value, count] : totals) {
    const auto wanted = published_total().find(value);
    sum += std::abs(count - (wanted == published_total().end() ? 0 : wanted->second));
  }
  for (const auto& [value, count] : published_total()) sum += totals.contains(value) ? 0 : count;
  return sum;
}

}  // namespace

const Histogram& published_flat() {
  static const Histogram table = {{0, 27}, {1, 30}, {2, 16}, {3, 14}, {4, 7}, {5, 7}, {6, 2}};
  return table;
}

const Histogram& published_solid() {
  static const Histogram table = {{0, 1}, {1, 6}, {2, 9}, {3, 24}, {4, 22}, {5, 23}, {6, 17}, {7, 1}};
  return table;
}

const Histogram& published_total() {
  static const Histogram table = {{3, 9},  {4, 19}, {5, 20}, {6, 28}, {7, 10},
                                  {8, 11}, {9, 4},  {10, 1}, {12, 1}};
  return table;
}

std::vector<SceneCount> scene_counts(int scenes, Random random) {
  // Any pairing has the first two histograms; exchanges that bring the totals no further away lead to one
  // that has the third.
  const std::vector<int> flat = values_of(published_flat());
  std::vector<int> solid = values_of(published_solid());
  std::reverse(solid.begin(), solid.end());
  Histogram totals;
  for (size_t i = 0; i < flat.size(); ++i) ++totals[flat[i] + solid[i]];
  int away = distance(totals);
  constexpr int kTries = 2000000;
  for (int attempt = 0; attempt < kTries && away > 0; ++attempt) {
    const size_t a = random.index(flat.size()), b = random.index(flat.size());
    if (flat[a] == flat[b] || solid[a] == solid[b]) continue;
    Histogram changed = totals;
    --changed[flat[a] + solid[a]];
    --changed[flat[b] + solid[b]];
    ++changed[flat[a] + solid[b]];
    ++changed[flat[b] + solid[a]];
    const int now = distance(changed);
    if (now > away) continue;
    std::swap(solid[a], solid[b]);
    totals = std::move(changed);
    away = now;
  }
  if (away > 0) throw Error("no scenes were found that have the published numbers of objects");
  std::vector<SceneCount> all;
  for (size_t i = 0; i < flat.size(); ++i) all.push_back({flat[i], solid[i]});
  shuffle(all, random);
  std::vector<SceneCount> result;
  for (int i = 0; i < scenes; ++i) result.push_back(all[static_cast<size_t>(i) % all.size()]);
  return result;
}

}  // namespace loci::apps::system_evaluation
