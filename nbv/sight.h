#pragma once

#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/laser.h"

namespace loci::nbv {

/// What a scanner sees of surfaces in space that is known in part: occupied voxels hide what is behind them,
/// unknown ones do not.
class Sight {
 public:
  /// Keeps references.
  Sight(const mapping::Voxels& voxels, const mapping::LaserModel& laser) : voxels_(voxels), laser_(laser) {}

  /// Whether a scanner at `from` sees a point of a surface with that outward normal: from its front side,
  /// within its tilts and its nearest range, with nothing in between. In which direction it looks is left
  /// out, see in_sector().
  bool sees(const Vector3d& from, const Vector3d& point, const Vector3d& normal) const;

 private:
  bool hidden(const Vector3d& from, const Vector3d& to) const;

  const mapping::Voxels& voxels_;
  const mapping::LaserModel& laser_;
};

/// Whether a direction is in the sector that a scanner with that yaw (radians) sweeps.
bool in_sector(const Vector3d& from, const Vector3d& to, double yaw, const mapping::LaserModel& laser);

}  // namespace loci::nbv
