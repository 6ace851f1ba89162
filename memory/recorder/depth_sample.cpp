#include "memory/recorder/depth_sample.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "memory/store/scene_images.h"

namespace loci::memory {

namespace {

int step_of(const cv::Mat& image) {
  return std::max(1, (std::max(image.cols, image.rows) + 159) / 160);
}

}  // namespace

DepthSample depth_sample(const cv::Mat& depth) {
  const int step = step_of(depth);
  DepthSample small{depth.cols / step, depth.rows / step, {}};
  std::vector<float> values;
  for (int row = 0; row < small.height; ++row) {
    for (int column = 0; column < small.width; ++column) {
      const int v = row * step + step / 2, u = column * step + step / 2;
      float value = depth.at<float>(v, u);
      for (int i = 0; i < step * step && !std::isfinite(value); ++i)
        value = depth.at<float>(row * step + i / step, column * step + i % step);
      values.push_back(std::isfinite(value) ? value : 0.0F);
    }
  }
  small.bytes = encode_depth_thumbnail(values);
  return small;
}

std::string kind_sample(const cv::Mat& kinds) {
  const int step = step_of(kinds);
  std::string bytes;
  for (int row = 0; row < kinds.rows / step; ++row)
    for (int column = 0; column < kinds.cols / step; ++column) {
      uint8_t kind = kinds.at<uint8_t>(row * step + step / 2, column * step + step / 2);
      for (int i = 0; i < step * step && kind == 0; ++i)
        kind = kinds.at<uint8_t>(row * step + i / step, column * step + i % step);
      bytes.push_back(static_cast<char>(kind));
    }
  return bytes;
}

}  // namespace loci::memory
