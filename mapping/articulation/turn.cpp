#include "mapping/articulation/turn.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math.h"
#include "mapping/base/quantile.h"

namespace loci::mapping {
namespace {

constexpr double kOutlierShare = 0.1;

Vector3d turn_vector(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  const double angle = turn.angle() > kPi ? turn.angle() - 2 * kPi : turn.angle();
  return angle * turn.axis();
}

}  // namespace

TurnFit fit_turn(const std::vector<Eigen::Quaterniond>& orientations, const Vector3d& axis,
                 const std::vector<double>& joint_positions, const std::vector<double>& weights) {
  std::vector<Eigen::Quaterniond> starts;
  for (size_t i = 0; i < orientations.size(); ++i)
    if (weights[i] > 0.5)
      starts.push_back(Eigen::Quaterniond(Eigen::AngleAxisd(-joint_positions[i], axis)) * orientations[i]);
  TurnFit fit;
  if (starts.empty()) return fit;

  // Weiszfeld's algorithm: the rotation of least summed angle, which flips do not pull away.
  fit.start = starts[starts.size() / 2];
  std::vector<Vector3d> errors(starts.size());
  for (int round = 0; round < 20; ++round) {
    Vector3d step = Vector3d::Zero();
    double total = 0;
    for (size_t i = 0; i < starts.size(); ++i) {
      errors[i] = turn_vector(starts[i] * fit.start.conjugate());
      const double weight = 1 / (errors[i].norm() + 1e-3);
      step += weight * errors[i];
      total += weight;
    }
    step /= total;
    if (step.norm() < 1e-9) break;
    fit.start = Eigen::Quaterniond(Eigen::AngleAxisd(step.norm(), step.normalized())) * fit.start;
  }
  for (const Vector3d& error : errors) fit.angles.push_back(error.norm());
  fit.sigma = median(fit.angles) / 1.538;  // 1.538: median length of a normal vector in space

  double variance = 0, correlation = 1;
  for (const Vector3d& e : errors) variance += e.squaredNorm();
  for (size_t lag = 1; lag < errors.size() / 2; ++lag) {
    double product = 0;
    for (size_t i = lag; i < errors.size(); ++i) product += errors[i].dot(errors[i - lag]);
    if (variance <= 0 || product < 0.05 * variance) break;
    correlation += 2 * product / variance;
  }
  const double count = static_cast<double>(errors.size());
  fit.effective_poses = std::clamp(count / correlation, std::min(4.0, count), count);
  return fit;
}

double TurnFit::log_likelihood(double noise, double poses) const {
  const double log_outlier = std::log(kOutlierShare) - std::log(8 * kPi * kPi);
  const double log_peak = std::log(1 - kOutlierShare) - 3 * (std::log(noise) + 0.5 * std::log(2 * kPi));
  double sum = 0;
  for (const double angle : angles) {
    const double log_inlier = log_peak - 0.5 * angle * angle / (noise * noise);
    const double largest = std::max(log_inlier, log_outlier);
    sum += largest + std::log(std::exp(log_inlier - largest) + std::exp(log_outlier - largest));
  }
  return angles.empty() ? 0 : sum * poses / static_cast<double>(angles.size());
}

}  // namespace loci::mapping
