#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// Heights over a plane (CV_32F, metres, image of a depth camera, NaN = none) made heights over the surface
/// near the plane that bends as a whole: a polynomial of second degree, fitted to what most of the pixels
/// show. It takes away what a sensor distorts and how a board sags, and no thing, however wide.
cv::Mat over_bent_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                          const Vector3d& normal, double offset);

/// Whether a thing (`pixels` of the depth image) lies higher than what is next to it by at least `step_m`
/// along its border, and rises along nearly all of it. The border is cut into short pieces, each compared
/// with the ground right beside it, so that neither slopes nor waves of the surface matter, and what is only
/// painted (paper, shadows, seams between boards) does not rise. `heights`: of single pixels, not smoothed.
/// `ground` (CV_8U): pixels that may be compared with.
bool rises_all_around(const cv::Mat& heights, const std::vector<int>& pixels, const cv::Mat& ground,
                      double step_m);

}  // namespace loci::perception
