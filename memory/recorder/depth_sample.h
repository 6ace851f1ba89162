#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace loci::memory {

/// A depth image small enough to be kept with every scene: the bytes of a depth thumbnail.
struct DepthSample {
  int width = 0, height = 0;
  std::string bytes;
};

/// Every so-many-th pixel, so that the longer side has at most 160; where that one was not measured, the
/// first around it that was.
DepthSample depth_sample(const cv::Mat& depth);
/// What these pixels are: the bytes of pixel_kinds(), from an image of the depth image's size.
std::string kind_sample(const cv::Mat& kinds);

}  // namespace loci::memory
