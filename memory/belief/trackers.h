#pragma once

#include <array>
#include <optional>
#include <vector>

#include "memory/belief/decisions.h"
#include "memory/belief/scene_matrices.h"

namespace loci::belief {

/// The simple trackers of §6.1.2: each looks at one thing alone.
inline constexpr std::array<const char*, 3> kTrackers{"position", "shape", "color"};

/// Which believed object (its key) an observation is by each tracker: that which is nearest to it while it is
/// the nearest to that, by the offset of their centres, by their extents, by their colours. Unset = nothing
/// near enough, nothing to compare, or not mutual.
struct TrackerVotes {
  std::array<std::optional<int64_t>, kTrackers.size()> key;
  /// All trackers say so, and nothing else comes near: what the arbiter would settle without the model.
  std::optional<int64_t> settled;
};

/// One per observation, from what is kept with a scene.
std::vector<TrackerVotes> votes(const SceneMatrices& matrices);

/// How often the arbiter settles, and how often the model says the same.
struct ArbiterCount {
  size_t observations = 0, settled = 0, as_model = 0;

  void add(const SceneMatrices& matrices, const Decisions& decisions);
};

}  // namespace loci::belief
