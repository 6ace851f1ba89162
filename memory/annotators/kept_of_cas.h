#pragma once

#include "memory/recorder/scene_record.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {

/// Adds to a scene_record() of this CAS what the memory keeps and the belief does not look at: what each
/// pixel is, what annotators noted and how long they took, and with `clouds` the points of each cluster.
void add_what_is_kept(const perception::types::SceneCas& scene, bool clouds, SceneRecord& record);

}  // namespace loci::memory
