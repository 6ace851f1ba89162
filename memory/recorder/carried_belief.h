#pragma once

#include "memory/belief/state.h"
#include "memory/store/scene_transaction.h"

namespace loci {

/// Keeps the belief with a scene: a blob, named by an annotation of the scene.
void save_belief(SceneTransaction& transaction, Id scene, const belief::BeliefState& state);

}  // namespace loci
