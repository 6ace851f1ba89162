#include "perception/recognition/color_agreement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci::perception {
namespace {

constexpr int kWhite = 245;
constexpr double kSigma = 25;  // of Lab: another light shifts colours, another flavour changes them
constexpr int kFewCells = 30;
constexpr double kUnknown = 0.5;

}  // namespace

cv::Mat chroma_of(const cv::Mat& image, int side) {
  cv::Mat small, lab;
  const double scale = std::min(1.0, static_cast<double>(side) / std::max(image.cols, image.rows));
  cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(small, lab, cv::COLOR_BGR2Lab);
  cv::Mat chroma(small.size(), CV_8UC3);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x) {
      const auto& color = small.at<cv::Vec3b>(y, x);
      const auto& cell = lab.at<cv::Vec3b>(y, x);
      const bool coloured = std::min({color[0], color[1], color[2]}) < kWhite;
      chroma.at<cv::Vec3b>(y, x) = {cell[1], cell[2], static_cast<uint8_t>(coloured ? 255 : 0)};
    }
  return chroma;
}

double color_agreement(const cv::Mat& from, const cv::Size& from_size, const cv::Mat& to,
                       const cv::Size& to_size, const cv::Matx23d& to_from_from) {
  const double from_scale = static_cast<double>(from_size.width) / from.cols;
  const double to_scale = static_cast<double>(to.cols) / to_size.width;
  double sum = 0;
  int count = 0;
  for (int y = 0; y < from.rows; ++y)
    for (int x = 0; x < from.cols; ++x) {
      const auto& ours = from.at<cv::Vec3b>(y, x);
      if (ours[2] == 0) continue;
      const cv::Vec2d pixel = to_from_from * cv::Vec3d((x + 0.5) * from_scale, (y + 0.5) * from_scale, 1);
      const int u = static_cast<int>(std::floor(pixel[0] * to_scale)),
                v = static_cast<int>(std::floor(pixel[1] * to_scale));
      if (u < 0 || v < 0 || u >= to.cols || v >= to.rows) continue;
      const auto& theirs = to.at<cv::Vec3b>(v, u);
      const double da = ours[0] - theirs[0], db = ours[1] - theirs[1];
      sum += std::exp(-(da * da + db * db) / (2 * kSigma * kSigma));
      ++count;
    }
  return count < kFewCells ? kUnknown : sum / count;
}

}  // namespace loci::perception
