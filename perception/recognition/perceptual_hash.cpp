#include "perception/recognition/perceptual_hash.h"

#include <algorithm>
#include <array>
#include <bit>
#include <opencv2/imgproc.hpp>

namespace loci::perception {
namespace {

constexpr int kSide = 32, kFrequencies = 8, kColorCells = 4;

}  // namespace

uint64_t perceptual_hash(const cv::Mat& image) {
  if (image.empty()) return 0;
  cv::Mat grey = image, small, spectrum;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::resize(grey, small, {kSide, kSide}, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::dct(small, spectrum);
  // Without the first row and column, which say how bright it is, and from where light comes.
  std::array<float, kFrequencies * kFrequencies> values{};
  for (int v = 0; v < kFrequencies; ++v)
    for (int u = 0; u < kFrequencies; ++u)
      values[static_cast<size_t>(v * kFrequencies + u)] = spectrum.at<float>(v + 1, u + 1);
  std::array<float, kFrequencies* kFrequencies> sorted = values;
  const auto middle = sorted.begin() + sorted.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  uint64_t hash = 0;
  for (size_t i = 0; i < values.size(); ++i)
    if (values[i] >= *middle) hash |= uint64_t{1} << i;
  return hash;
}

cv::Mat cell_colors(const cv::Mat& image) {
  cv::Mat small, colors;
  cv::resize(image, small, {kColorCells, kColorCells}, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F, 1.0 / 255);
  cv::cvtColor(small, colors, cv::COLOR_BGR2Lab);
  return colors;
}

int hash_distance(uint64_t a, uint64_t b) {
  return std::popcount(a ^ b);
}

}  // namespace loci::perception
