#pragma once

#include <optional>

#include "mapping/base/text/json_fwd.h"
#include "perception/types/scene_cas.h"

namespace loci::perception::types {

/// Whether features that are arrays of numbers or texts are written: a descriptor has thousands.
enum class Arrays { left_out, written };
/// What an annotation says in words and numbers, whatever its type.
Json to_json(const Annotation& annotation, Arrays arrays = Arrays::left_out);
/// The number of a cluster of the scene, from 1, as outputs have it; nothing for others.
std::optional<size_t> number_of(const SceneCas& scene, const Identifiable& cluster);
/// What was perceived of a scene: supports, clusters with their annotations, relations between them,
/// annotations of the scene.
Json to_json(const SceneCas& scene);

}  // namespace loci::perception::types
