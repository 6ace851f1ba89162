#include "memory/belief/kept_votes.h"

#include <algorithm>
#include <limits>

namespace loci::memory::belief {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Of the first of these kinds that the scene has.
std::vector<double> looks(const SceneMatrices& matrices, std::initializer_list<const char*> kinds) {
  std::vector<double> values;
  for (const char* kind : kinds) {
    const auto found = std::ranges::find(matrices.kinds, kind);
    if (found == matrices.kinds.end()) continue;
    for (const uint8_t distance : matrices.distances[static_cast<size_t>(found - matrices.kinds.begin())])
      values.push_back(distance == SceneMatrices::kNone8 ? kFar : distance * SceneMatrices::kDistanceStep);
    return values;
  }
  values.assign(matrices.rows * matrices.keys.size(), kFar);
  return values;
}

}  // namespace

std::vector<TrackerVotes> votes(const SceneMatrices& matrices) {
  TrackerDistances distances{matrices.rows, matrices.keys, {}};
  for (const uint16_t offset : matrices.offsets)
    distances.of[0].push_back(offset == SceneMatrices::kNone16 ? kFar : 0.001 * offset);
  distances.of[1] = looks(matrices, {"extents"});
  distances.of[2] = looks(matrices, {"color_histogram", "mean_color"});
  return votes(distances);
}

void ArbiterCount::add(const SceneMatrices& matrices, const Decisions& decisions) {
  const std::vector<TrackerVotes> voted = votes(matrices);
  for (size_t k = 0; k < std::min(voted.size(), decisions.observations.size()); ++k) {
    ++observations;
    if (!voted[k].settled) continue;
    ++settled;
    as_decided += voted[k].settled == decisions.observations[k].key ? 1 : 0;
  }
}

}  // namespace loci::memory::belief
