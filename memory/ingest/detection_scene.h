#pragma once

#include "memory/ingest/detections.h"
#include "memory/recorder/scene_record.h"

namespace loci::memory {

/// The record of a scene of detections for belief and memory. `sigma_m` is the noise of positions of
/// detections without their own. `map_places` are those of the map; others are as the detections name them.
/// The caller sets recording, map and number of the row.
SceneRecord detections_to_scene(const DetectedScene& scene, double sigma_m,
                                const std::vector<PlaceRow>& map_places);

/// The supports of a map's sidecar as places.
std::vector<PlaceRow> places_of_map(const std::filesystem::path& urdf);

}  // namespace loci::memory
