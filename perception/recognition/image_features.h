#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace loci::perception {

/// A SIFT descriptor as RootSIFT (Arandjelovic and Zisserman, CVPR 2012) in bytes: 512 times the square root
/// of each share, so that the squared distance of two lies between 0 and 2 · 512².
using Descriptor = std::array<uint8_t, 128>;

/// Squared Euclidean distance.
int squared_distance(const Descriptor& a, const Descriptor& b);

/// Where a descriptor was taken, in pixels of the image as it was given.
struct Keypoint {
  float x = 0, y = 0;
  float size = 0;   ///< diameter of the neighbourhood
  float angle = 0;  ///< radian, of the gradient that it is upright to
};

struct ImageFeatures {
  int width = 0, height = 0;  ///< of the image as it was given
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;  ///< one per key point
};

/// SIFT features of an image (CV_8UC3, BGR, or CV_8UC1). It is scaled so that its longer side has `side`
/// pixels first: what small and large images show is then described at like scales. The strongest `most`
/// are kept. A uniform image has none.
ImageFeatures image_features(const cv::Mat& image, int side, int most);

}  // namespace loci::perception
