#include "mapping/tracking/noise_estimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/base/math/math.h"

namespace loci::mapping::tracking {
namespace {

constexpr struct {
  size_t frames = 12;       ///< spread over the recording
  int reach = 50;           ///< the second differences reach over the width of the image by this: 12 of 640
                            ///< pixels, beyond what neighbouring pixels share
  int stride = 5;           ///< px between them
  size_t min_count = 1000;  ///< that say anything
} kNoise;

/// Second differences of inverse depth along one direction, absolute. At edges they are large and few.
void add_differences(const cv::Mat& depth, int du, int dv, std::vector<double>& differences) {
  for (int v = dv; v + dv < depth.rows; v += kNoise.stride)
    for (int u = du; u + du < depth.cols; u += kNoise.stride) {
      const auto before = static_cast<double>(depth.at<float>(v - dv, u - du)),
                 middle = static_cast<double>(depth.at<float>(v, u)),
                 after = static_cast<double>(depth.at<float>(v + dv, u + du));
      if (before > 0 && middle > 0 && after > 0)
        differences.push_back(std::abs(1 / before - 2 / middle + 1 / after));
    }
}

}  // namespace

std::optional<double> depth_noise_per_z2(const Recording& recording) {
  std::vector<double> differences;
  const size_t count = std::min(recording.size(), kNoise.frames);
  for (size_t i = 0; i < count; ++i) {
    const cv::Mat depth = recording.frame(i * recording.size() / count).depth;
    const int reach = std::max(1, depth.cols / kNoise.reach);
    add_differences(depth, reach, 0, differences);
    add_differences(depth, 0, reach, differences);
  }
  if (differences.size() < kNoise.min_count) return std::nullopt;
  // A normal distribution has half its values within 0.6745 σ; the variance of 1 -2 1 is 6 σ².
  return median(std::move(differences)) / (0.6745 * std::sqrt(6.0));
}

}  // namespace loci::mapping::tracking
