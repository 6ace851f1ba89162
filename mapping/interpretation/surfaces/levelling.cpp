#include "mapping/interpretation/surfaces/levelling.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/moments.h"
#include "mapping/base/math/pose.h"
#include "mapping/interpretation/surfaces/parameters.h"

namespace loci::mapping {
namespace {

/// Directions that many normals share, most frequent first.
std::vector<Vector3d> normal_peaks(const Surface& surface, const Vector3d& up, size_t max_count) {
  CellIndex bins;
  std::vector<Vector3d> sums;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d normal = point.normal.cast<double>();
    if (normal.dot(up) < 0.5) continue;
    const uint32_t number = bins.insert(cell_of(normal, 0.1));
    if (number == sums.size()) sums.emplace_back(Vector3d::Zero());
    sums[number] += normal;
  }
  std::stable_sort(sums.begin(), sums.end(),
                   [](const auto& a, const auto& b) { return a.norm() > b.norm(); });
  if (sums.size() > max_count) sums.resize(max_count);
  for (Vector3d& sum : sums) sum.normalize();
  return sums;
}

struct FloorPlane {
  Vector3d normal;
  double offset = 0;  ///< normal · p
  size_t inliers = 0;
};

/// The lowest height along `normal` with many inliers and almost no points below.
std::optional<FloorPlane> floor_along(const Surface& surface, const Vector3d& normal) {
  double lowest = 1e9;
  double highest = -1e9;
  for (const SurfacePoint& point : surface.points) {
    const double height = normal.dot(point.position.cast<double>());
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  std::vector<size_t> all(static_cast<size_t>((highest - lowest) / kLevels.bin_m) + 2, 0);
  std::vector<size_t> fitting(all.size(), 0);
  for (const SurfacePoint& point : surface.points) {
    const auto bin =
        static_cast<size_t>((normal.dot(point.position.cast<double>()) - lowest) / kLevels.bin_m);
    ++all[bin];
    if (point.normal.cast<double>().dot(normal) > 0.95) ++fitting[bin];
  }
  const size_t min_inliers = *std::max_element(fitting.begin(), fitting.end()) / 5;
  size_t below = 0;
  for (size_t bin = 0; bin + 1 < all.size(); ++bin) {
    const size_t inliers = fitting[bin] + fitting[bin + 1];
    if (inliers > min_inliers && inliers > 200)
      return FloorPlane{normal, lowest + kLevels.bin_m * static_cast<double>(bin + 1), inliers};
    below += all[bin];
    if (below > surface.points.size() / 20) return std::nullopt;
  }
  return std::nullopt;
}

/// Repeated least squares over the points near the plane.
FloorPlane refined(const Surface& surface, FloorPlane plane) {
  for (const double tolerance : {0.06, 0.03, 0.03}) {
    Moments<3> inliers;
    for (const SurfacePoint& point : surface.points) {
      const Vector3d position = point.position.cast<double>();
      if (std::abs(plane.normal.dot(position) - plane.offset) > tolerance) continue;
      if (point.normal.cast<double>().dot(plane.normal) < 0.95) continue;
      inliers.add(position);
    }
    if (inliers.count < 100) break;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inliers.covariance());
    Vector3d normal = solver.eigenvectors().col(0);
    if (normal.dot(plane.normal) < 0) normal = -normal;
    plane = {normal, normal.dot(inliers.mean()), static_cast<size_t>(inliers.count)};
  }
  return plane;
}

}  // namespace

std::optional<LevelHeight> level_height(const std::map<uint16_t, std::vector<double>>& heights_by_scan,
                                        size_t min_points) {
  LevelHeight level;
  std::vector<double> medians;
  for (const auto& [scan, heights] : heights_by_scan) {
    if (heights.size() < min_points) continue;
    level.scans.push_back(scan);
    medians.push_back(median(heights));
  }
  if (medians.empty()) return std::nullopt;
  level.height = median(medians);
  double squares = 0;
  for (const double value : medians) squares += (value - level.height) * (value - level.height);
  level.sd = std::sqrt(squares / static_cast<double>(medians.size()));
  return level;
}

std::optional<Isometry3d> level_by_floor(const Surface& surface, const Vector3d& up) {
  std::optional<FloorPlane> best;
  for (const Vector3d& direction : normal_peaks(surface, up, 8)) {
    auto plane = floor_along(surface, direction);
    if (!plane) continue;
    plane = refined(surface, *plane);
    if (!best || plane->inliers > best->inliers) best = plane;
  }
  if (!best) return std::nullopt;
  Isometry3d levelled = Isometry3d::Identity();
  levelled.linear() = rotation_between(best->normal, Vector3d::UnitZ());
  levelled.translation().z() = -best->offset;
  return levelled;
}

std::vector<Vector3d> up_hints(const ScanSet& scans) {
  Vector3d sum = Vector3d::Zero();
  for (const Scan& scan : scans.scans) sum -= scan.map_from_scan.linear().col(1);
  // Recordings were turned upright as far as they show what is up, however the camera was held.
  if (scans.sensor == kDepthCameraSensor && sum.norm() > 1e-6) return {Vector3d::UnitZ(), sum.normalized()};
  return {Vector3d::UnitZ(), -Vector3d::UnitY(), Vector3d::UnitY()};
}

double room_yaw(const Surface& surface) {
  constexpr double kTurn = 2 * kPi;
  std::array<double, kLevels.yaw_bins> histogram{};
  std::vector<double> angles;
  for (const SurfacePoint& point : surface.points) {
    if (point.normal.isZero() || std::abs(point.normal.z()) > 0.2F) continue;
    const double angle =
        4 * std::atan2(static_cast<double>(point.normal.y()), static_cast<double>(point.normal.x()));
    const double fraction = angle / kTurn - std::floor(angle / kTurn);
    angles.push_back(fraction * kTurn);
    ++histogram[std::min(kLevels.yaw_bins - 1, static_cast<size_t>(fraction * kLevels.yaw_bins))];
  }
  if (angles.empty()) return 0;
  size_t peak = 0;
  double max_sum = -1;
  for (size_t bin = 0; bin < kLevels.yaw_bins; ++bin) {
    double sum = 0;
    for (size_t d = 0; d < 9; ++d) sum += histogram[(bin + kLevels.yaw_bins + d - 4) % kLevels.yaw_bins];
    if (sum > max_sum) {
      max_sum = sum;
      peak = bin;
    }
  }
  double centre = (static_cast<double>(peak) + 0.5) / kLevels.yaw_bins * kTurn;
  for (const double window : {0.35, 0.2, 0.14}) {
    double sum = 0;
    double count = 0;
    for (const double angle : angles) {
      const double difference = std::remainder(angle - centre, kTurn);
      if (std::abs(difference) > window) continue;
      sum += difference;
      ++count;
    }
    if (count > 0) centre += sum / count;
  }
  return std::remainder(centre, kTurn) / 4;
}

}  // namespace loci::mapping
