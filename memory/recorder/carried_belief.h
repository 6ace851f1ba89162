#pragma once

#include "memory/belief/state.h"
#include "memory/store/scene_transaction.h"

namespace loci {

/// Keeps the belief as it is after a scene, in the place of the one before.
void save_belief(SceneTransaction& transaction, Id scene, const belief::BeliefState& state);

}  // namespace loci
