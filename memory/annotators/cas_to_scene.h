#pragma once

#include "mapping/world/world.h"
#include "memory/recorder/scene_record.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {

/// Whether the heads of people are blurred in the images that are stored.
enum class People { blurred, kept };

/// Converts a processed CAS: what the belief compares and what the memory stores. `world` (may be null) gives
/// the poses of places that move with a joint. The row's recording and map are left to the caller.
SceneRecord scene_record(const perception::types::SceneCas& scene, const mapping::World* world,
                         People people = People::blurred);

/// An annotation and its searchable value.
AnnotationRecord annotation_record(const perception::types::Annotation& annotation);

/// A relation of the scene as a searchable value of its first object: "left-of cluster 3", "on island_1". The
/// first is the index of that object among the clusters; nothing for relations of others.
std::optional<std::pair<size_t, AnnotationRecord>> relation_record(
    const perception::types::SceneCas& scene, const perception::types::Relation& relation);

/// Descriptors of a cluster that the belief can compare. `camera`: from where it was seen, map frame.
std::vector<belief::Descriptor> descriptors_of(const perception::types::Cluster& cluster,
                                               const Vector3d& camera);

/// Adds to a scene_record() of this CAS what the memory stores and the belief does not use: pixel kinds, logs
/// of the annotators with their times, and with `clouds` the points of each cluster.
void add_stored_data(const perception::types::SceneCas& scene, bool clouds, SceneRecord& record);

}  // namespace loci::memory
