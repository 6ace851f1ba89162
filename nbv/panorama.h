#pragma once

#include <vector>

#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/laser.h"
#include "nbv/fringe.h"

namespace loci::nbv {

/// What a view from a pose would show, as areas perpendicular to its rays, m².
struct ViewCounts {
  double occupied = 0;  ///< n_o: known surfaces that would be seen again
  double fringe = 0;    ///< n_f: what may be seen anew behind the fringe

  double overlap() const { return occupied + fringe > 0 ? occupied / (occupied + fringe) : 0; }
};

/// Casts the sensor's rays into the voxels, coarsely: a ray stands for the solid angle around it, so that it
/// counts with the area that this covers where it ends. A ray that goes through the fringe counts where it
/// leaves the unknown again, at most 1 m deep, and in proportion to that depth: thin shadows hide little, and
/// a window that is close by shows more than its own area.
class ViewCaster {
 public:
  /// `step_deg`: angle between rays. Rays count up to `range_max` metres. Keeps references.
  ViewCaster(const mapping::Voxels& voxels, const ViewVoxels& view, const mapping::LaserModel& laser,
             double range_max, double step_deg);

  /// All around from a place on the floor: counts per column of rays, column 0 at azimuth 0.
  std::vector<ViewCounts> panorama(const Vector2d& place) const;
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

}  // namespace loci::nbv
