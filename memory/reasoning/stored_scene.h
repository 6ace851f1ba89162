#pragma once

#include "memory/recorder/scene_reasoning.h"
#include "memory/recorder/scene_record.h"

namespace loci::memory {

/// A stored scene as the belief took it in, to reason about it again: its rows and evidence; depth is that of
/// the thumbnail. Without annotations and images. Error when the evidence is of other observations.
SceneRecord stored_scene(const Store& store, const SceneRow& row, const SceneReasoning& reasoning,
                         const std::vector<PlaceRow>& places);

}  // namespace loci::memory
