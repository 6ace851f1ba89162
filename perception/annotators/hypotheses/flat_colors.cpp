#include "perception/annotators/hypotheses/flat_colors.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace loci::perception {
namespace {

constexpr float kMaxByColor = 4;
constexpr float kMaxByHeight = 3;

/// Shares of the pixels per bin of saturation (rows) and hue (columns), blurred so that the noise of the
/// colours does not matter.
cv::Mat histogram_of(const cv::Mat& bin_of, const cv::Mat& mask, int bins) {
  cv::Mat histogram = cv::Mat::zeros(bins, bins, CV_32F);
  auto* count = histogram.ptr<float>();
  for (int v = 0; v < bin_of.rows; ++v) {
    const auto* bin = bin_of.ptr<uint16_t>(v);
    const auto* in = mask.ptr<unsigned char>(v);
    for (int u = 0; u < bin_of.cols; ++u)
      if (in[u]) count[bin[u]] += 1;
  }
  // Hue is a circle.
  cv::Mat wrapped;
  cv::copyMakeBorder(histogram, wrapped, 0, 0, 3, 3, cv::BORDER_WRAP);
  cv::GaussianBlur(wrapped, wrapped, {5, 5}, 0.8);
  histogram = wrapped.colRange(3, 3 + bins).clone();
  return histogram / std::max(1.0, cv::sum(histogram)[0]);
}

}  // namespace

cv::Mat color_bins(const cv::Mat& color, int bins) {
  cv::Mat hsv;
  cv::GaussianBlur(color, hsv, {3, 3}, 0);
  cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV_FULL);
  cv::Mat bin_of(color.size(), CV_16U);
  for (int v = 0; v < color.rows; ++v) {
    const auto* pixel = hsv.ptr<cv::Vec3b>(v);
    auto* bin = bin_of.ptr<uint16_t>(v);
    for (int u = 0; u < color.cols; ++u)
      bin[u] = static_cast<uint16_t>(pixel[u][1] * bins / 256 * bins + pixel[u][0] * bins / 256);
  }
  return bin_of;
}

cv::Mat color_log_odds(const cv::Mat& bin_of, const FlatSeeds& seeds, int bins) {
  const cv::Mat table = histogram_of(bin_of, seeds.table, bins);
  const cv::Mat object = histogram_of(bin_of, seeds.object, bins);
  // A colour that neither class has shown says nothing.
  const float unseen = 0.1f / static_cast<float>(bins * bins);
  std::vector<float> odds_of(static_cast<size_t>(bins * bins));
  for (size_t i = 0; i < odds_of.size(); ++i) {
    const float ratio = (object.ptr<float>()[i] + unseen) / (table.ptr<float>()[i] + unseen);
    odds_of[i] = std::clamp(std::log(ratio), -kMaxByColor, kMaxByColor);
  }
  cv::Mat odds(bin_of.size(), CV_32F);
  for (int v = 0; v < odds.rows; ++v)
    for (int u = 0; u < odds.cols; ++u) odds.ptr<float>(v)[u] = odds_of[bin_of.ptr<uint16_t>(v)[u]];
  return odds;
}

cv::Mat height_log_odds(const cv::Mat& heights, double table_m, double object_m, double noise) {
  const auto middle = static_cast<float>((table_m + object_m) / 2);
  // Two normal distributions, as far apart as an object at the limit and the surface itself.
  const auto slope = static_cast<float>(2 * middle / (noise * noise));
  cv::Mat odds(heights.size(), CV_32F);
  for (int v = 0; v < odds.rows; ++v)
    for (int u = 0; u < odds.cols; ++u) {
      const float height = heights.ptr<float>(v)[u];
      odds.ptr<float>(v)[u] =
          std::isnan(height) ? 0 : std::clamp(slope * (height - middle), -kMaxByHeight, kMaxByHeight);
    }
  return odds;
}

}  // namespace loci::perception
