#include "perception/annotators/segmentation/clustering/color_contrast.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perception/recognition/image_features.h"

namespace loci::perception {
namespace {

/// What is at most `distance` pixels from a region.
cv::Mat grown(const cv::Mat& region, int distance) {
  cv::Mat result;
  cv::dilate(region, result, cv::Mat::ones(2 * distance + 1, 2 * distance + 1, CV_8U));
  return result;
}

}  // namespace

double color_contrast(const cv::Mat& color, const cv::Rect& box, const cv::Mat& mask, const cv::Mat& ground) {
  constexpr int kEdge = 3;  // pixels at an edge show a bit of both
  constexpr int kAround = 10;
  constexpr int kMinPixels = 10;
  const cv::Rect around =
      cv::Rect(box.x - kAround, box.y - kAround, box.width + 2 * kAround, box.height + 2 * kAround) &
      cv::Rect({}, color.size());
  cv::Mat region = cv::Mat::zeros(around.size(), CV_8U);
  mask.copyTo(region(box - around.tl()));
  const cv::Mat beside = grown(region, kAround) & ~grown(region, kEdge) & ground(around);
  cv::Mat inner;
  cv::erode(region, inner, cv::Mat::ones(3, 3, CV_8U));
  if (cv::countNonZero(inner) < kMinPixels) inner = region;
  if (cv::countNonZero(beside) < kMinPixels) return 0;
  const cv::Mat lab = lab_of(color(around));
  cv::Scalar own, own_spread, other, other_spread;
  cv::meanStdDev(lab, own, own_spread, inner);
  cv::meanStdDev(lab, other, other_spread, beside);
  double contrast = 0;
  for (int c = 0; c < 3; ++c) {
    const double variance = (std::pow(own_spread[c], 2) + std::pow(other_spread[c], 2)) / 2;
    contrast += std::pow(own[c] - other[c], 2) / std::max(1.0, variance);  // colours come in steps of one
  }
  return std::sqrt(contrast);
}

}  // namespace loci::perception
