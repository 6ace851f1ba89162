#pragma once

#include "memory/belief/decisions.h"
#include "memory/belief/scene_matrices.h"
#include "memory/belief/trackers.h"

namespace loci::memory::belief {

/// What the trackers said of each observation, from what is kept with a scene.
std::vector<TrackerVotes> votes(const SceneMatrices& matrices);

/// How often the arbiter settles, and how often that is what was decided.
struct ArbiterCount {
  size_t observations = 0, settled = 0, as_decided = 0;

  void add(const SceneMatrices& matrices, const Decisions& decisions);
};

}  // namespace loci::memory::belief
