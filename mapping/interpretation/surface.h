#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/base/pose.h"
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
};

/// All scans as one surface in the map frame, with the rays that measured it.
struct Surface {
  std::vector<SurfacePoint> points;
  std::vector<Eigen::Vector3f> origins;
  std::vector<uint16_t> scan_of_origin;
  std::vector<std::pair<Eigen::Vector3f, uint32_t>>
      free_ends;           ///< ends of rays that hit nothing, and their origins
  bool free_space = true;  ///< whether origins are known
  size_t scans = 0;
};

/// Gathers points and estimates normals within each scan (drift between scans would blur them); the
/// neighbourhood grows where points are few or far, as a depth camera's noise does. Same result on any number
/// of threads.
Surface gather_surface(const ScanSet& scans, int threads, Progress& progress);

/// Moves everything into another frame.
void transform(Surface& surface, const Isometry3d& target_from_source);

}  // namespace loci::mapping
