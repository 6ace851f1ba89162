#include "memory/belief/evidence/proximity.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

double square(double x) {
  return x * x;
}

/// How far `inner` extends beyond `outer` on each axis.
Vector3d excess(const AxisBox& inner, const AxisBox& outer) {
  return (inner.high() - outer.high()).cwiseMax(outer.low() - inner.low()).cwiseMax(0.0);
}

Vector3d gap(const AxisBox& a, const AxisBox& b) {
  return (a.low() - b.high()).cwiseMax(b.low() - a.high()).cwiseMax(0.0);
}

/// Horizontally against a uniform density. All objects stand on their place, so height is only evidence
/// against.
double position_log_ratio(const Vector3d& offset, const PositionNoise& noise, double spread, double area) {
  const double vertical_variance = (noise.known + noise.stated) + square(kParameters.vertical_noise_m);
  return std::log(area) + noise.log_density(square(offset.x()) + square(offset.y()), spread) -
         square(offset.z()) / (2 * vertical_variance);
}

/// An object that stays keeps its extents along the axes of the map.
double extent_penalty(const AxisBox& believed, const AxisBox& seen, double variance) {
  double penalty = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::max(believed.size[axis], seen.size[axis]);
    penalty -=
        square(seen.size[axis] - believed.size[axis]) /
        (2 * (square(kParameters.extent_noise_m + kParameters.extent_noise_per_size * size) + 4 * variance));
  }
  return std::max(kParameters.min_extent_log_ratio, penalty);
}

}  // namespace

NoiseScale::Levels PositionNoise::densities(double squared_offset, double spread) const {
  NoiseScale::Levels result{};
  for (size_t i = 0; i < NoiseScale::kLevels; ++i) {
    const double variance = known + square(NoiseScale::kFactors[i]) * stated;
    result[i] = std::exp(-squared_offset / (2 * variance)) / (2 * kPi * (variance + spread));
  }
  return result;
}

double PositionNoise::log_density(double squared_offset, double spread) const {
  const NoiseScale::Levels density = densities(squared_offset, spread);
  double sum = 0;
  for (size_t i = 0; i < NoiseScale::kLevels; ++i) sum += weights[i] * density[i];
  return std::log(std::max(1e-300, sum));
}

double observation_variance(const Observation& observation, const BeliefOptions& options) {
  if (observation.sigma_m) return square(*observation.sigma_m);
  return square(options.noise_m) + square(options.noise_per_m2 * square(observation.range)) +
         square(options.noise_per_size * observation.box.size.maxCoeff());
}

double camera_motion(const Isometry3d& from, const Isometry3d& to) {
  const Isometry3d change = from.inverse() * to;
  return change.translation().norm() + Eigen::AngleAxisd(change.linear()).angle();
}

double view_change_variance(const Isometry3d& from, const Isometry3d& to, double size,
                            const BeliefOptions& options) {
  const double motion = camera_motion(from, to);
  return square(options.pose_noise_m * (1 - std::exp(-motion / kParameters.pose_error_motion))) +
         square(options.view_bias * size * (1 - std::exp(-motion / kParameters.turn_motion)));
}

double short_move_ratio(const Vector3d& offset, const BeliefOptions& options) {
  const double variance = square(options.nudge_m);
  return options.area_m2 * std::exp(-offset.head<2>().squaredNorm() / (2 * variance)) / (2 * kPi * variance);
}

double log_proximity(const AxisBox& box, const PositionNoise& noise, bool box_partial,
                     const Observation& observation, const BeliefOptions& options) {
  // Most of a partial object is visible, so that its centre hardly shifts. Two parts shift by themselves, and
  // are of something that is as large as both together.
  const bool both = box_partial && observation.partial;
  const double size =
      (both ? join(box, observation.box).size : box.size.cwiseMax(observation.box.size).eval()).maxCoeff();
  const double spread = (both ? 2 : 1) * square(size / 6);
  const double shift = (observation.box.centre - box.centre).head<2>().squaredNorm() /
                       (2 * (spread + noise.known + noise.stated));
  if (both) return position_log_ratio(gap(box, observation.box), noise, spread, options.area_m2) - shift;
  if (observation.partial)
    return position_log_ratio(excess(observation.box, box), noise, spread, options.area_m2) - shift;
  if (box_partial)
    return position_log_ratio(excess(box, observation.box), noise, spread, options.area_m2) - shift;
  return position_log_ratio(observation.box.centre - box.centre, noise, 0, options.area_m2) +
         extent_penalty(box, observation.box, (noise.known + noise.stated));
}

}  // namespace loci::memory::belief
