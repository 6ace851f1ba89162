#include "memory/recorder/depth_sample.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "memory/store/depth_thumbnail.h"

namespace loci {

DepthSample depth_sample(const cv::Mat& depth) {
  const int step = std::max(1, (std::max(depth.cols, depth.rows) + 159) / 160);
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

}  // namespace loci
