#pragma once

#include <opencv2/core.hpp>

namespace loci::mapping {

/// SIFT descriptors (CV_32F, one per row) as RootSIFT (Arandjelovic and Zisserman, CVPR 2012): the square
/// root of each value's share of its row. Rows have length one, and Euclidean distances between them compare
/// like Hellinger's.
cv::Mat root_sift(const cv::Mat& descriptors);

}  // namespace loci::mapping
