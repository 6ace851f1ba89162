#include "perception/annotators/hypotheses/upright_outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace loci::perception {

OutlineBand outline_band(const std::vector<Eigen::Vector3f>& cloud, const std::vector<int>& members,
                         const Eigen::Vector2f& viewpoint, float low, float high) {
  using Eigen::Vector2f;
  OutlineBand band;
  std::vector<std::pair<float, Vector2f>> seen;
  Vector2f mean = Vector2f::Zero();
  for (const int i : members) {
    const Eigen::Vector3f& p = cloud[static_cast<size_t>(i)];
    if (p.z() < low || p.z() > high) continue;
    seen.emplace_back(0.0f, p.head<2>());
    mean += p.head<2>();
  }
  band.points = static_cast<int>(seen.size());
  if (seen.empty()) return band;
  mean /= static_cast<float>(seen.size());
  band.distance = (mean - viewpoint).norm();
  const Vector2f ahead = (mean - viewpoint).normalized();
  band.across = Vector2f(-ahead.y(), ahead.x());
  for (auto& [angle, p] : seen) angle = std::atan2(band.across.dot(p - viewpoint), ahead.dot(p - viewpoint));
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const size_t tail = seen.size() / 50;
  const auto& right = seen[tail];
  const auto& left = seen[seen.size() - 1 - tail];
  band.width = band.distance * (left.first - right.first);
  band.middle = viewpoint + Eigen::Rotation2Df(0.5f * (left.first + right.first)) * (band.distance * ahead);
  return band;
}

}  // namespace loci::perception
