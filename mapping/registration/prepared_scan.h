#pragma once

#include <string>
#include <vector>

#include "mapping/registration/free_space.h"
#include "mapping/registration/registration.h"
#include "mapping/registration/surfels.h"

namespace loci::mapping::registration {

/// A scan made ready for aligning, once for all its pairs. Its points are in the scan's frame or, for planar
/// registration, in that frame turned upright: there a robot's pose is x, y and yaw.
struct PreparedScan {
  std::string name;
  Isometry3d level_from_scan = Isometry3d::Identity();
  std::vector<Surfels> levels;  ///< finest first, cells twice as wide each
  CellGrid net;                 ///< wide, over the coarsest level
  FreeSpace free_space;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< mean of the origins: the scan is turned about it
  size_t points = 0;                                 ///< that were returned

  const Surfels& finest() const { return levels.front(); }
  const Surfels& coarsest() const { return levels.back(); }
};

PreparedScan prepare(const Scan& scan, const RegistrationOptions& options);

}  // namespace loci::mapping::registration
