#include "memory/belief/trackers.h"

#include <algorithm>
#include <limits>

namespace loci::belief {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Distances of one tracker, observations × objects; kFar = not comparable.
struct Distances {
  size_t rows, columns;
  std::vector<double> values;
  double farthest;  ///< nothing beyond is proposed
  double margin;    ///< so much farther, and twice as far, must be what else there is to settle

  double at(size_t k, size_t o) const { return values[k * columns + o]; }

  /// The object that is nearest to an observation while the observation is nearest to it.
  std::optional<size_t> mutual(size_t k) const {
    size_t best = 0;
    for (size_t o = 1; o < columns; ++o)
      if (at(k, o) < at(k, best)) best = o;
    if (columns == 0 || !(at(k, best) <= farthest)) return std::nullopt;
    for (size_t other = 0; other < rows; ++other)
      if (at(other, best) < at(k, best)) return std::nullopt;
    return best;
  }

  bool nothing_else_near(size_t k, size_t o) const {
    const double least = 2 * at(k, o) + margin;
    for (size_t other = 0; other < columns; ++other)
      if (other != o && at(k, other) < least) return false;
    for (size_t other = 0; other < rows; ++other)
      if (other != k && at(other, o) < least) return false;
    return true;
  }
};

Distances positions(const SceneMatrices& matrices) {
  Distances result{matrices.rows, matrices.keys.size(), {}, 0.1, 0.05};
  for (const uint16_t offset : matrices.offsets)
    result.values.push_back(offset == SceneMatrices::kNone16 ? kFar : 0.001 * offset);
  return result;
}

/// Of the first of these kinds that the scene has.
Distances looks(const SceneMatrices& matrices, std::initializer_list<const char*> kinds, double farthest) {
  Distances result{matrices.rows, matrices.keys.size(), {}, farthest, 0.05};
  for (const char* kind : kinds) {
    const auto found = std::ranges::find(matrices.kinds, kind);
    if (found == matrices.kinds.end()) continue;
    for (const uint8_t distance : matrices.distances[static_cast<size_t>(found - matrices.kinds.begin())])
      result.values.push_back(distance == SceneMatrices::kNone8 ? kFar
                                                                : distance * SceneMatrices::kDistanceStep);
    return result;
  }
  result.values.assign(result.rows * result.columns, kFar);
  return result;
}

}  // namespace

std::vector<TrackerVotes> votes(const SceneMatrices& matrices) {
  const std::array<Distances, kTrackers.size()> trackers{
      positions(matrices), looks(matrices, {"extents"}, 0.25),
      looks(matrices, {"color_histogram", "mean_color"}, 0.6)};
  std::vector<TrackerVotes> all(matrices.rows);
  for (size_t k = 0; k < all.size(); ++k) {
    bool agree = true;
    for (size_t t = 0; t < trackers.size(); ++t) {
      const std::optional<size_t> o = trackers[t].mutual(k);
      if (o) all[k].key[t] = matrices.keys[*o];
      agree = agree && o && all[k].key[t] == all[k].key[0];
    }
    if (agree && trackers[0].nothing_else_near(k, *trackers[0].mutual(k))) all[k].settled = all[k].key[0];
  }
  return all;
}

void ArbiterCount::add(const SceneMatrices& matrices, const Decisions& decisions) {
  const std::vector<TrackerVotes> voted = votes(matrices);
  for (size_t k = 0; k < std::min(voted.size(), decisions.observations.size()); ++k) {
    ++observations;
    if (!voted[k].settled) continue;
    ++settled;
    as_model += voted[k].settled == decisions.observations[k].key ? 1 : 0;
  }
}

}  // namespace loci::belief
