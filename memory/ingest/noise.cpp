#include "memory/ingest/noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mapping/base/quantile.h"

namespace loci::memory {
namespace {

/// What lies farther from everything that was there is another thing.
constexpr double kNear_m = 0.3;
constexpr size_t kMin = 60;  ///< differences, that is twenty things seen twice
constexpr size_t kMax = 200'000;
constexpr double kMin_m = 0.002, kMax_m = 0.2;

size_t nearest(const Vector3d& position, const std::vector<Detection>& among) {
  size_t best = 0;
  for (size_t i = 1; i < among.size(); ++i)
    if ((among[i].position - position).squaredNorm() < (among[best].position - position).squaredNorm())
      best = i;
  return best;
}

}  // namespace

void PositionNoise::add(const DetectedScene& scene) {
  if (!before_.empty() && !scene.detections.empty() && differences_.size() < kMax) {
    for (size_t i = 0; i < scene.detections.size(); ++i) {
      const Vector3d& position = scene.detections[i].position;
      const Vector3d& earlier = before_[nearest(position, before_)].position;
      if ((position - earlier).norm() > kNear_m || nearest(earlier, scene.detections) != i) continue;
      for (int axis = 0; axis < 3; ++axis) differences_.push_back(std::abs(position[axis] - earlier[axis]));
    }
  }
  before_ = scene.detections;
}

std::optional<double> PositionNoise::sigma_m() const {
  if (differences_.size() < kMin) return std::nullopt;
  // The median of |d| is 0.6745 standard deviations, and both looks are noisy.
  return std::clamp(median(differences_) / 0.6745 / std::numbers::sqrt2, kMin_m, kMax_m);
}

}  // namespace loci::memory
