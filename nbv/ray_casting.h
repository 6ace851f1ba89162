#pragma once

#include <vector>

#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/laser.h"
#include "nbv/frontier.h"

namespace loci::nbv {

/// Expected content of a view, as areas perpendicular to its rays, m².
struct ViewCounts {
  double occupied = 0;  ///< n_o: known surfaces seen again
  double frontier = 0;  ///< n_f: surfaces that may appear behind the frontier

  double overlap() const { return occupied + frontier > 0 ? occupied / (occupied + frontier) : 0; }
};

/// Casts a subset of the sensor's rays into the voxels. Each ray represents the solid angle around it and
/// counts with the area that this angle covers where the ray ends. A ray through the frontier counts where it
/// leaves the unknown again, at most 1 m deep, and in proportion to that depth: thin shadows hide little, and
/// a frontier close to the sensor reveals more than its own area.
class ViewCaster {
 public:
  /// `step_deg`: angle between rays. Rays count up to `range_max` metres. Keeps references.
  ViewCaster(const mapping::Voxels& voxels, const ViewVoxels& view, const mapping::LaserModel& laser,
             double range_max, double step_deg);

  /// All around from a point on the floor: counts per column of rays, column 0 at azimuth 0.
  std::vector<ViewCounts> panorama(const Vector2d& point) const;
  /// The part of a panorama that the sensor sees when it looks along `yaw` (radians).
  ViewCounts part(const std::vector<ViewCounts>& panorama, double yaw) const;
  /// One view alone, casting no other rays than its own.
  ViewCounts view(const mapping::PlanarPose& pose) const;

 private:
  ViewCounts column(const Vector3d& origin, double azimuth) const;
  void cast(const Vector3d& origin, const Vector3d& direction, double area, ViewCounts& counts) const;

  const mapping::Voxels& voxels_;
  const ViewVoxels& view_;
  double height_, opening_, range_max_, step_;
  int columns_;
  struct Tilt {
    double sine, cosine;
  };
  std::vector<Tilt> tilts_;
};

/// Tests lines of sight of a scanner in partly known space: occupied voxels hide what is behind them, unknown
/// ones do not.
class LineOfSight {
 public:
  /// Keeps references.
  LineOfSight(const mapping::Voxels& voxels, const mapping::LaserModel& laser)
      : voxels_(voxels), laser_(laser) {}

  /// Whether a scanner at `from` sees a point of a surface with that outward normal: from its front side,
  /// within the scanner's tilts and ranges, with nothing in between. The scanner's yaw is ignored, see
  /// in_sector().
  bool sees(const Vector3d& from, const Vector3d& point, const Vector3d& normal) const;

 private:
  bool hidden(const Vector3d& from, const Vector3d& to) const;

  const mapping::Voxels& voxels_;
  const mapping::LaserModel& laser_;
};

/// Whether a direction is in the sector that a scanner with that yaw (radians) sweeps.
bool in_sector(const Vector3d& from, const Vector3d& to, double yaw, const mapping::LaserModel& laser);

}  // namespace loci::nbv
