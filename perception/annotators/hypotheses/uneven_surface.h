#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/pose.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// Heights over a plane (CV_32F, metres, image of a depth camera, NaN = none) made heights over the uneven
/// surface that lies about the plane, as far as one image tells: in a top view the heights are opened
/// morphologically with a disc of diameter `window_m`, which takes away what is narrower; what then is lower
/// than `object_m` is the surface and is averaged over its surroundings.
cv::Mat over_uneven_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                            const Vector3d& normal, double offset, double window_m, double object_m);

}  // namespace loci::perception
