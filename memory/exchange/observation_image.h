#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "mapping/sensor/scan.h"
#include "memory/store/store.h"

namespace loci {

/// Which pixels of the depth image an observation has: CV_8U of the depth camera's size, 255 = its own.
/// Without a mask its region of interest; empty when neither is there (let go, or never given).
cv::Mat mask_of(const Store& store, const SceneRow& scene, const ObservationRow& observation);

/// Whose pixels they are: CV_16U of the depth camera's size, the number of the object that is believed to be
/// seen there, 0 = none. Empty when the scene has no camera or nothing in it has a mask. Error for objects
/// above 65535.
cv::Mat label_picture(const Store& store, const SceneRow& scene, const AsOf& as_of = {});

/// The surface of an observation as far as the memory has it: its points, where they are kept, else the
/// pixels of the depth thumbnail under its mask; map frame, coloured by the scene's picture where that is
/// kept (taken to be registered with the depth). One origin, the camera. Unset when depth, mask, camera or
/// pose are missing, or no pixel is left.
std::optional<Scan> cloud_of(const Store& store, const SceneRow& scene, const ObservationRow& observation);

}  // namespace loci
