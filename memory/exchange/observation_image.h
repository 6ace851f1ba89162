#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "mapping/sensor/scan.h"
#include "memory/store/scene_images.h"
#include "memory/store/store.h"

namespace loci::memory {

/// Which pixels of the depth image an observation has: CV_8U of the depth camera's size, 255 = its own.
/// Without a mask its region of interest; empty without either.
cv::Mat mask_of(const Store& store, const SceneRow& scene, const ObservationRow& observation);

/// Whose pixels they are: CV_16U of the depth camera's size, the number of the object that is believed to be
/// seen there, 0 = none. Empty when the scene has no camera or nothing in it has a mask. Error for objects
/// above 65535.
cv::Mat label_image(const Store& store, const SceneRow& scene, const AsOf& as_of = {});

/// The points of an observation as far as the memory has them: the stored ones, else those of the depth
/// thumbnail under its mask. Empty when depth, mask or camera are missing, or no pixel is left.
ClusterPoints measured_points(const Store& store, const SceneRow& scene, const ObservationRow& observation);

/// The surface of an observation as far as the memory has it: its measured points in the map frame,
/// coloured by the scene's image where that is stored (assumed to be registered with the depth). One origin,
/// the camera. Unset when there are none, or the pose is missing.
std::optional<mapping::Scan> cloud_of(const Store& store, const SceneRow& scene,
                                      const ObservationRow& observation);

}  // namespace loci::memory
