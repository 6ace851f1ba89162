#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/sensor/camera.h"

namespace loci::perception {

/// Where an object is in the colour image.
struct ColorRegion {
  cv::Rect box;  ///< in the colour image; empty when the object falls outside it
  cv::Mat mask;  ///< CV_8U, of the box's size: 255 = object
};

/// Projects pixels of the depth image (indices row · width + column into `points`, CV_32FC3 in the camera
/// frame) through the registration of the two cameras into a colour image of `size`, and closes the gaps
/// between them.
ColorRegion color_region(const cv::Mat& points, const std::vector<int>& pixels,
                         const mapping::RgbdCamera& camera, const cv::Size& size);

}  // namespace loci::perception
