#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace loci::apps::segmentation_evaluation {

/// An image, and beside it the truth and several segmentations (CV_16U, 0 = none) painted on it in grey; all
/// made smaller by `scale`.
cv::Mat strip(const cv::Mat& color, const cv::Mat& truth, const std::vector<cv::Mat>& segments, double scale);

}  // namespace loci::apps::segmentation_evaluation
