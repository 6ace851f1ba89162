#include "mapping/articulation/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/base/math.h"

namespace loci::mapping {
namespace {

constexpr int kAzimuths = 720, kElevations = 360;
constexpr float kNone = std::numeric_limits<float>::infinity();
constexpr double kReach = 8;  // metres

struct Cell {
  int azimuth, elevation;
};

Cell cell_of_direction(const Vector3d& d) {
  const double azimuth = std::atan2(d.y(), d.x()) / (2 * kPi) + 0.5;
  const double elevation = std::asin(std::clamp(d.z() / d.norm(), -1.0, 1.0)) / kPi + 0.5;
  return {std::min(static_cast<int>(azimuth * kAzimuths), kAzimuths - 1),
          std::min(static_cast<int>(elevation * kElevations), kElevations - 1)};
}

size_t index_of(int azimuth, int elevation) {
  return static_cast<size_t>(elevation * kAzimuths + (azimuth + kAzimuths) % kAzimuths);
}

}  // namespace

FreeSpace::FreeSpace(const ScanSet& set, const Vector3d& near, double tolerance) : tolerance_(tolerance) {
  if (!set.free_space) return;
  for (const Scan& scan : set.scans) {
    const size_t first = views_.size();
    for (const Eigen::Vector3f& origin : scan.origins)
      views_.push_back({scan.map_from_scan * origin.cast<double>(),
                        std::vector<float>(static_cast<size_t>(kAzimuths) * kElevations, kNone)});
    for (const ScanPoint& point : scan.points) {
      View& view = views_[first + point.origin_index];
      const Vector3d ray = scan.map_from_scan * point.position.cast<double>() - view.origin;
      const auto [azimuth, elevation] = cell_of_direction(ray);
      float& least = view.least[index_of(azimuth, elevation)];
      least = std::min(least, static_cast<float>(ray.norm()));
    }
  }
  std::erase_if(views_, [&](const View& view) { return (view.origin - near).norm() > kReach; });
}

bool FreeSpace::is_free(const Vector3d& point) const {
  for (const View& view : views_) {
    const Vector3d ray = point - view.origin;
    const double distance = ray.norm();
    const auto [azimuth, elevation] = cell_of_direction(ray);
    if (view.least[index_of(azimuth, elevation)] == kNone) continue;
    bool free = true;
    for (int e = std::max(elevation - 1, 0); e <= std::min(elevation + 1, kElevations - 1) && free; ++e)
      for (int a = azimuth - 1; a <= azimuth + 1 && free; ++a)
        free = view.least[index_of(a, e)] > distance + tolerance_;
    if (free) return true;
  }
  return false;
}

double FreeSpace::share_free(const std::vector<Vector3d>& points) const {
  size_t free = 0;
  for (const Vector3d& p : points) free += is_free(p);
  return points.empty() ? 0 : static_cast<double>(free) / static_cast<double>(points.size());
}

}  // namespace loci::mapping
