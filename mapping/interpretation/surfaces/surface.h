#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/progress.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

/// A measured point in the map frame.
struct SurfacePoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the sensor; zero = too few neighbours
  uint16_t scan = 0;
  uint32_t origin = 0;          ///< into Surface::origins
  float intensity = 0;          ///< as in ScanPoint
  uint8_t r = 0, g = 0, b = 0;  ///< colour

  /// Whether the normal is up within 20 degrees: part of a surface that carries objects.
  bool is_upward() const { return normal.z() > 0.94F; }
  /// Whether the point may be of such a surface although its normal is not up: near a vertical surface the
  /// neighbourhood of a normal holds both surfaces, and a few rows of points have no normal.
  bool may_be_upward() const { return !is_upward() && (normal.isZero() || normal.z() > 0.3F); }
};

/// All scans as one surface in the map frame, with the rays that measured it.
struct Surface {
  std::vector<SurfacePoint> points;
  std::vector<Eigen::Vector3f> origins;
  std::vector<uint16_t> scan_of_origin;
  /// Ends of rays without return, and their origins.
  std::vector<std::pair<Eigen::Vector3f, uint32_t>> free_ends;
  bool free_space = true;  ///< whether origins are known
  size_t scans = 0;
};

/// Gathers points and estimates normals within each scan, as drift between scans would blur them. The
/// neighbourhood grows with the range, as a depth camera's noise does, and where points are few. Same result
/// on any number of threads.
Surface gather_surface(const ScanSet& scans, int threads, Progress& progress);

/// Transforms points, normals and rays into another frame.
void transform(Surface& surface, const Isometry3d& target_from_source);

/// Removes scans that are upside down (between floor and ceiling, furniture shows tops, not undersides), and
/// notes them and scans without returns. Error when most scans are upside down.
void remove_bad_scans(const ScanSet& scans, Surface& surface, std::vector<std::string>& notes);

}  // namespace loci::mapping
