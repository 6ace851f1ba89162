#pragma once

#include <opencv2/core.hpp>
#include <utility>

#include "mapping/sensor/camera.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Normal n (unit, up) and offset of a support's plane in the camera's frame, n · p = offset, metres. `pose`
/// = map_from_camera.
std::pair<Vector3d, double> plane_in_camera(const types::PlanarSupport& support, const Isometry3d& pose);

/// Pixels of the depth image within the outline of a support, CV_8U, 255 = inside.
cv::Mat pixels_over(const types::PlanarSupport& support, const Isometry3d& camera_from_map,
                    const mapping::PinholeCamera& camera);

/// Takes out of `inside` (CV_8U) the pixels where the map shows something that stands over a support: a
/// front, a shelf or the side of a drawer hides it there. `normal` and `offset` as in the camera's frame,
/// metres; `map_depth`: CV_32F, what the map alone would measure, NaN = nothing.
void leave_out_what_the_map_hides(const cv::Mat& map_depth, const Vector3d& normal, double offset,
                                  const mapping::PinholeCamera& camera, cv::Mat& inside);

/// The clusters' pixels and those within `margin` of them, which show a bit of both; CV_8U, 255.
cv::Mat pixels_of_clusters(const types::SceneCas& scene, const cv::Size& size, int margin);

}  // namespace loci::perception
