#pragma once

#include "memory/belief/scene_matrices.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {

/// What the belief was told about a scene, without images, and what it made of it: enough to explain it
/// later and to reason anew.
struct SceneReasoning {
  belief::Scene evidence;  ///< view without camera and images, which the scene's row has
  belief::Decisions decisions;
  belief::SceneMatrices matrices;  ///< empty where an earlier version wrote it
};

/// Kept with the scene, compact.
void save_reasoning(SceneTransaction& transaction, Id scene, const belief::Scene& evidence,
                    const belief::Decisions& decisions, const belief::SceneMatrices& matrices);
/// Unset for scenes of which none was kept (other writers, earlier versions).
std::optional<SceneReasoning> load_reasoning(const Store& store, Id scene);

}  // namespace loci::memory
