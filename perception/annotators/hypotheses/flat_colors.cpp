#include "perception/annotators/hypotheses/flat_colors.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci {
namespace {

constexpr float kMostByColor = 4;
constexpr float kMostByHeight = 3;

/// Shares of the pixels per bin of saturation (rows) and hue (columns), blurred so that the noise of the
/// colours does not matter.
cv::Mat histogram_of(const cv::Mat& hsv, const cv::Mat& mask, int bins) {
  cv::Mat histogram = cv::Mat::zeros(bins, bins, CV_32F);
  for (int v = 0; v < hsv.rows; ++v)
    for (int u = 0; u < hsv.cols; ++u) {
      if (!mask.at<unsigned char>(v, u)) continue;
      const cv::Vec3b& pixel = hsv.at<cv::Vec3b>(v, u);
      histogram.at<float>(pixel[1] * bins / 256, pixel[0] * bins / 256) += 1;
    }
  // Hue is a circle.
  cv::Mat wrapped;
  cv::copyMakeBorder(histogram, wrapped, 0, 0, 3, 3, cv::BORDER_WRAP);
  cv::GaussianBlur(wrapped, wrapped, {5, 5}, 0.8);
  histogram = wrapped.colRange(3, 3 + bins).clone();
  return histogram / std::max(1.0, cv::sum(histogram)[0]);
}

}  // namespace

cv::Mat color_log_odds(const cv::Mat& color, const FlatSeeds& seeds, int bins) {
  cv::Mat hsv;
  cv::GaussianBlur(color, hsv, {3, 3}, 0);
  cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV_FULL);
  const cv::Mat table = histogram_of(hsv, seeds.table, bins);
  const cv::Mat object = histogram_of(hsv, seeds.object, bins);
  // A colour that neither class has shown says nothing.
  const float unseen = 0.1f / static_cast<float>(bins * bins);
  cv::Mat odds(color.size(), CV_32F);
  for (int v = 0; v < odds.rows; ++v)
    for (int u = 0; u < odds.cols; ++u) {
      const cv::Vec3b& pixel = hsv.at<cv::Vec3b>(v, u);
      const int row = pixel[1] * bins / 256;
      const int column = pixel[0] * bins / 256;
      const float ratio = (object.at<float>(row, column) + unseen) / (table.at<float>(row, column) + unseen);
      odds.at<float>(v, u) = std::clamp(std::log(ratio), -kMostByColor, kMostByColor);
    }
  return odds;
}

cv::Mat height_log_odds(const cv::Mat& heights, double table_m, double object_m, double noise) {
  const auto middle = static_cast<float>((table_m + object_m) / 2);
  // Two normal distributions, as far apart as an object at the limit and the surface itself.
  const auto slope = static_cast<float>(2 * middle / (noise * noise));
  cv::Mat odds(heights.size(), CV_32F);
  for (int v = 0; v < odds.rows; ++v)
    for (int u = 0; u < odds.cols; ++u) {
      const float height = heights.at<float>(v, u);
      odds.at<float>(v, u) =
          std::isnan(height) ? 0 : std::clamp(slope * (height - middle), -kMostByHeight, kMostByHeight);
    }
  return odds;
}

}  // namespace loci
