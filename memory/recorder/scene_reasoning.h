#pragma once

#include "memory/belief/association/decisions.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

using belief::SceneReasoning;

/// Stores the reasoning with its scene.
void save_reasoning(SceneTransaction& transaction, Id scene, const SceneReasoning& reasoning);
/// Unset for scenes without (other writers, or deleted by a rule of retention).
std::optional<SceneReasoning> load_reasoning(const Store& store, Id scene);

}  // namespace loci::memory
