#include "perception/recognition/image_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace loci::perception {
namespace {

// Half of Lowe's threshold: packages show soft shades, and matching sorts out what is noise.
constexpr double kContrast = 0.02;
constexpr double kEdge = 12;

Descriptor root_sift(const float* values) {
  float sum = 0;
  for (int i = 0; i < 128; ++i) sum += values[i];
  Descriptor descriptor;
  for (size_t i = 0; i < 128; ++i)
    descriptor[i] = cv::saturate_cast<uint8_t>(512 * std::sqrt(values[i] / std::max(sum, 1.0f)));
  return descriptor;
}

cv::Mat grey_of_side(const cv::Mat& image, int side, double& scale) {
  cv::Mat grey = image, scaled;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  scale = static_cast<double>(side) / std::max(image.cols, image.rows);
  cv::resize(grey, scaled, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return scaled;
}

}  // namespace

ImageFeatures image_features(const cv::Mat& image, int side, int most) {
  double scale = 1;
  const cv::Mat grey = grey_of_side(image, side, scale);
  std::vector<cv::KeyPoint> found;
  cv::Mat values;
  cv::SIFT::create(most, 3, kContrast, kEdge)->detectAndCompute(grey, cv::noArray(), found, values);
  ImageFeatures features;
  features.width = image.cols;
  features.height = image.rows;
  const auto to_given = static_cast<float>(1 / scale);
  for (size_t i = 0; i < found.size(); ++i) {
    features.keypoints.push_back({found[i].pt.x * to_given, found[i].pt.y * to_given,
                                  found[i].size * to_given, found[i].angle * std::numbers::pi_v<float> / 180});
    features.descriptors.push_back(root_sift(values.ptr<float>(static_cast<int>(i))));
  }
  return features;
}

}  // namespace loci::perception
