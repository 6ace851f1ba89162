#include "mapping/interpretation/surfaces/levelling.h"

#include <fmt/format.h>

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

/// Points by height along a direction.
struct HeightHistogram {
  double lowest = 0;
  std::vector<size_t> all, fitting;  ///< the latter with normals along the direction

  size_t inliers(size_t bin) const { return fitting[bin] + fitting[bin + 1]; }
  FloorPlane plane(const Vector3d& normal, size_t bin) const {
    return {normal, lowest + kLevels.bin_m * static_cast<double>(bin + 1), inliers(bin)};
  }
};

HeightHistogram heights_along(const Surface& surface, const Vector3d& normal) {
  double lowest = 1e9;
  double highest = -1e9;
  for (const SurfacePoint& point : surface.points) {
    const double height = normal.dot(point.position.cast<double>());
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  HeightHistogram heights;
  heights.lowest = lowest;
  heights.all.resize(static_cast<size_t>((highest - lowest) / kLevels.bin_m) + 2, 0);
  heights.fitting.resize(heights.all.size(), 0);
  for (const SurfacePoint& point : surface.points) {
    const auto bin =
        static_cast<size_t>((normal.dot(point.position.cast<double>()) - lowest) / kLevels.bin_m);
    ++heights.all[bin];
    if (point.normal.cast<double>().dot(normal) > 0.95) ++heights.fitting[bin];
  }
  return heights;
}

constexpr size_t kMinInliers = 200;  // of a plane to level by

/// The lowest height along `normal` with many inliers and almost no points below.
std::optional<FloorPlane> floor_along(const Surface& surface, const Vector3d& normal) {
  const HeightHistogram heights = heights_along(surface, normal);
  const size_t min_inliers = *std::max_element(heights.fitting.begin(), heights.fitting.end()) / 5;
  size_t below = 0;
  for (size_t bin = 0; bin + 1 < heights.all.size(); ++bin) {
    if (heights.inliers(bin) > std::max(min_inliers, kMinInliers)) return heights.plane(normal, bin);
    below += heights.all[bin];
    if (below > surface.points.size() / 20) return std::nullopt;
  }
  return std::nullopt;
}

/// The height along `normal` with most inliers.
std::optional<FloorPlane> largest_along(const Surface& surface, const Vector3d& normal) {
  const HeightHistogram heights = heights_along(surface, normal);
  size_t best = 0;
  for (size_t bin = 1; bin + 1 < heights.all.size(); ++bin)
    if (heights.inliers(bin) > heights.inliers(best)) best = bin;
  if (heights.inliers(best) <= kMinInliers) return std::nullopt;
  return heights.plane(normal, best);
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

std::optional<Isometry3d> level_by(const Surface& surface, const Vector3d& up,
                                   std::optional<FloorPlane> (*plane_along)(const Surface&,
                                                                            const Vector3d&)) {
  std::optional<FloorPlane> best;
  for (const Vector3d& direction : normal_peaks(surface, up, 8)) {
    auto plane = plane_along(surface, direction);
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

/// What the views show of the plane at z = 0 and around it.
struct GroundView {
  double length = 0, width = 0;        ///< of what was seen of it
  double camera_height = 0;            ///< median over its points
  double drop_share = 0;               ///< of all points: below it, seen past its edges
  double high_share = 0;               ///< of all points: high above it
  std::optional<double> floor_height;  ///< of a level surface below it
};

/// The height of the lower level surface that has most of what faces up below z = 0.
std::optional<double> floor_below(const Surface& surface) {
  std::map<int64_t, size_t> counts;
  size_t all = 0;
  for (const SurfacePoint& point : surface.points) {
    const double z = static_cast<double>(point.position.z());
    if (!point.is_upward() || z > -kGround.min_drop_m) continue;
    ++counts[std::lround(z / kGround.on_plane_m)];
    ++all;
  }
  const auto most = std::max_element(counts.begin(), counts.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (all == 0 || most->second < kGround.min_floor_points ||
      static_cast<double>(most->second) < kGround.min_floor_share * static_cast<double>(all))
    return std::nullopt;
  std::vector<double> heights;
  for (const SurfacePoint& point : surface.points) {
    const double z = static_cast<double>(point.position.z());
    if (point.is_upward() &&
        std::abs(z - static_cast<double>(most->first) * kGround.on_plane_m) < kGround.on_plane_m)
      heights.push_back(z);
  }
  return median(std::move(heights));
}

GroundView view_of_ground(const Surface& surface) {
  const auto origin_of = [&](const SurfacePoint& point) {
    return Vector3d(surface.origins[point.origin].cast<double>());
  };
  Moments<2> positions;
  std::vector<Vector2d> on_plane;
  std::vector<double> camera_heights;
  CellIndex cells;
  const auto cell = [](double x, double y) { return cell_of(Vector3d(x, y, 0), kLevels.area_cell_m); };
  for (const SurfacePoint& point : surface.points) {
    if (std::abs(point.position.z()) > static_cast<float>(kGround.on_plane_m)) continue;
    const Vector2d at = point.position.head<2>().cast<double>();
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        cells.insert(cell(at.x() + dx * kLevels.area_cell_m, at.y() + dy * kLevels.area_cell_m));
    if (!point.is_upward()) continue;
    on_plane.push_back(at);
    positions.add(at);
    camera_heights.push_back(origin_of(point).z());
  }
  GroundView view;
  if (on_plane.empty()) return view;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(positions.covariance());
  const auto extent = [&](const Vector2d& axis) {
    std::vector<double> along;
    for (const Vector2d& at : on_plane) along.push_back(axis.dot(at));
    return quantile(along, 0.99) - quantile(along, 0.01);
  };
  view.length = extent(axes.eigenvectors().col(1));
  view.width = extent(axes.eigenvectors().col(0));
  view.camera_height = median(std::move(camera_heights));
  size_t below = 0, high = 0;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d at = point.position.cast<double>(), origin = origin_of(point);
    if (at.z() > kGround.high_m) ++high;
    if (at.z() > -kGround.min_drop_m || origin.z() <= 0) continue;
    // A mirror image is seen through the floor, what is below a top past its edge.
    const Vector3d crossing = origin + (at - origin) * (origin.z() / (origin.z() - at.z()));
    if (cells.find(cell(crossing.x(), crossing.y())) == CellIndex::kNone) ++below;
  }
  const auto all = static_cast<double>(surface.points.size());
  view.drop_share = static_cast<double>(below) / all;
  view.high_share = static_cast<double>(high) / all;
  view.floor_height = floor_below(surface);
  return view;
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
  return level_by(surface, up, floor_along);
}

std::optional<Isometry3d> level_by_largest_plane(const Surface& surface, const Vector3d& up) {
  return level_by(surface, up, largest_along);
}

Ground ground_of(const Surface& input, const Isometry3d& levelled) {
  Surface surface = input;
  transform(surface, levelled);
  const GroundView view = view_of_ground(surface);
  const auto because = [&](bool is_floor, bool certain, std::string reason) {
    return Ground{is_floor, certain, is_floor ? std::nullopt : view.floor_height, std::move(reason)};
  };
  if (view.length > kGround.max_length_m || view.width > kGround.max_width_m)
    return because(true, true, fmt::format("it is {:.1f} x {:.1f} m in size", view.length, view.width));
  if (view.drop_share > kGround.min_drop_share)
    return because(false, true, "beyond its edges the view goes down below it");
  if (view.camera_height > kGround.max_camera_m)
    return because(true, true, fmt::format("the camera was {:.1f} m over it", view.camera_height));
  if (view.high_share > kGround.min_high_share)
    return because(true, true, "furniture or walls stand beside it");
  return because(
      false, false,
      fmt::format("it fills the view, the camera was only {:.1f} m over it, and nothing high stands "
                  "on it",
                  view.camera_height));
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
