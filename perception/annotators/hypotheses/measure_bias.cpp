#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mapping/base/math.h"
#include "mapping/base/random.h"
#include "perception/annotators/hypotheses/depth_normals.h"

namespace loci::perception {
namespace {

/// A plane through the middle of a small image as the sensor would measure it.
cv::Mat plane_image(const mapping::PinholeCamera& camera, const NormalOptions& options,
                    const Vector3d& normal, double distance, Random& random) {
  const double bf = options.baseline_m * camera.fx;
  const double quantum = options.disparity_quantum_px;
  const double offset = normal.z() * distance;
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double inverse_depth = normal.dot(camera.unproject(u, v, 1)) / offset;
      const double disparity = bf * inverse_depth + random.normal(quantum / 2);
      if (inverse_depth > 0.1)
        depth.at<float>(v, u) = static_cast<float>(bf / (std::round(disparity / quantum) * quantum));
    }
  return depth;
}

/// Mean of the Gaussian around the peak of values: the mean of those within two deviations of it, three
/// times.
double mean_of_peak(const std::vector<double>& values) {
  double mean = 0, deviation = 10;
  for (int round = 0; round < 4 && !values.empty(); ++round) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const double value : values)
      if (std::abs(value - mean) <= 2 * deviation) {
        sum += value;
        squares += value * value;
        ++count;
      }
    if (count == 0) break;
    mean = sum / count;
    deviation = std::sqrt(std::max(0.0, squares / count - mean * mean)) + 1e-3;
  }
  return mean;
}

}  // namespace

InclinationBias measure_inclination_bias(const mapping::PinholeCamera& camera, const NormalOptions& options) {
  constexpr int kTurns = 4, kSize = 64, kMin = 200;
  constexpr double kMiddle = 1.2;
  mapping::PinholeCamera small = camera;
  small.width = small.height = kSize;
  small.cx = small.cy = kSize / 2.0;
  Random random(421);
  std::vector<double> missing[InclinationBias::kBins];
  DepthNormals found;
  for (double inclination = 2.5; inclination < 85; inclination += 2.5)
    for (int turn = 0; turn < kTurns; ++turn) {
      const double azimuth = (turn + random.uniform()) * 2 * kPi / kTurns;
      const double sine = std::sin(inclination * kDegree);
      const Vector3d normal(sine * std::cos(azimuth), sine * std::sin(azimuth),
                            -std::cos(inclination * kDegree));
      const cv::Mat depth = plane_image(small, options, normal, kMiddle, random);
      smooth_depth_and_normals(depth, small, options, InclinationBias(), found);
      for (int v = 0; v < kSize; ++v)
        for (int u = 0; u < kSize; ++u) {
          const cv::Vec3f& n = found.normals.at<cv::Vec3f>(v, u);
          if (std::isnan(n[0])) continue;
          const double estimate = std::acos(std::clamp(-static_cast<double>(n[2]), -1.0, 1.0)) / kDegree;
          const auto bin = static_cast<size_t>(
              std::min(estimate / InclinationBias::kBinDeg, InclinationBias::kBins - 1.0));
          missing[bin].push_back(inclination - estimate);
        }
    }
  InclinationBias::Table table = {};
  for (size_t bin = 0; bin < table.size(); ++bin)
    if (missing[bin].size() >= kMin) table[bin] = mean_of_peak(missing[bin]);
  return InclinationBias(table);
}

}  // namespace loci::perception
