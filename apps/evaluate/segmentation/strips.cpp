#include "apps/evaluate/segmentation/strips.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci::apps::segmentation_evaluation {
namespace {

cv::Mat painted(const cv::Mat& labels, const cv::Mat& background) {
  cv::Mat image;
  cv::cvtColor(background, image, cv::COLOR_BGR2GRAY);
  cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<uint16_t>(v, u);
      if (label == 0) continue;
      // Hues a golden section apart.
      const double hue = std::fmod(label * 0.618034, 1.0) * 6;
      const auto part = [&](double offset) {
        const double k = std::fmod(offset + hue, 6.0);
        return static_cast<unsigned char>(255 * (1 - std::clamp(std::min(k, 4 - k), 0.0, 1.0)));
      };
      image.at<cv::Vec3b>(v, u) =
          0.35 * image.at<cv::Vec3b>(v, u) + 0.65 * cv::Vec3b(part(1), part(3), part(5));
    }
  return image;
}

}  // namespace

cv::Mat strip(const cv::Mat& color, const cv::Mat& truth, const std::vector<cv::Mat>& segments,
              double scale) {
  std::vector<cv::Mat> images = {color, painted(truth, color)};
  for (const cv::Mat& each : segments) images.push_back(painted(each, color));
  for (cv::Mat& each : images) {
    cv::Mat smaller;
    cv::resize(each, smaller, {}, scale, scale, cv::INTER_AREA);
    each = smaller;
  }
  cv::Mat all;
  cv::hconcat(images, all);
  return all;
}

}  // namespace loci::apps::segmentation_evaluation
