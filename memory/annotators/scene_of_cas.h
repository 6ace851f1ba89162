#pragma once

#include "mapping/world/world.h"
#include "memory/recorder/scene_record.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {

/// Reads a processed CAS: what the belief compares and what the memory keeps. `world` (may be null) says
/// where places that move with a joint are. The row's recording and map are left to the caller.
SceneRecord scene_record(const perception::types::SceneCas& scene, const mapping::World* world);

/// An annotation with the value that it is searched by.
AnnotationRecord annotation_record(const perception::types::Annotation& annotation);

/// The numbers of a cluster's annotations that can be compared (distances live with the types).
std::vector<belief::Descriptor> descriptors_of(const perception::types::Cluster& cluster);

/// Box of points along the axes of the map: 1st to 99th percentile, since outliers are common.
belief::AxisBox robust_box(const std::vector<Vector3d>& points);

}  // namespace loci::memory
