#pragma once

#include <opencv2/core.hpp>

#include "mapping/sensor/camera.h"
#include "perception/types/scene_cas.h"

namespace loci {

/// Pixels of the depth picture within the outline of a support, CV_8U, 255 = inside.
cv::Mat pixels_over(const types::PlanarSupport& support, const Isometry3d& camera_from_map,
                    const PinholeCamera& camera);

/// The clusters' pixels and those within `margin` of them, which show a bit of both; CV_8U, 255.
cv::Mat pixels_of_clusters(const types::SceneCas& scene, const cv::Size& size, int margin);

}  // namespace loci
