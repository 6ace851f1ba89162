#pragma once

#include <opencv2/core.hpp>

namespace loci::perception {

/// How much the colours of a region differ from those of the ground around it: the distance of the means over
/// the standard deviation of a pixel, so that noise and texture have none. 0 where no ground is seen.
/// `color`: CV_8UC3, BGR; `mask`: CV_8U, of the size of `box`, 255 = region; `ground`: CV_8U, of the size of
/// `color`.
double color_contrast(const cv::Mat& color, const cv::Rect& box, const cv::Mat& mask, const cv::Mat& ground);

}  // namespace loci::perception
