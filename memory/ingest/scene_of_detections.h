#pragma once

#include "memory/ingest/detections.h"
#include "memory/recorder/scene_record.h"

namespace loci::memory {

/// What a moment of another system's detections means for belief and memory. `sigma_m` is the noise of
/// positions where a detection does not say its own. `map_places` are those of the map; others are named as
/// the detections name them. The row's recording, map and number are left to the caller.
SceneRecord scene_of_detections(const DetectedScene& scene, double sigma_m,
                                const std::vector<PlaceRow>& map_places);

/// The supports of a map's sidecar as places.
std::vector<PlaceRow> places_of_map(const std::filesystem::path& urdf);

}  // namespace loci::memory
