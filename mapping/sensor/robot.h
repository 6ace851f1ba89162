#pragma once

#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "mapping/sensor/laser.h"

namespace loci::mapping {

/// What pulling at a point did.
struct PullResult {
  /// Poses of the hand on the way as the robot believes them, map frame, first = before; empty = it found
  /// nothing to hold, one pose = what it held stands firm.
  std::vector<Isometry3d> hand_path;
  // What a simulated world knows besides, for evaluation; empty with a real robot.
  std::string link;   ///< that was taken hold of
  std::string joint;  ///< that gave way
  double moved = 0;   ///< metres or radians by which the joint opened, positive
};

/// Something that drives on the floor, scans and pulls handles: simulated or real.
class Robot {
 public:
  virtual ~Robot() = default;

  /// Goes to `goal` as far as it believes, scans there. The scan's pose (map_from_scan, covariance) is the
  /// robot's own estimate, which drifts. Error when it cannot get there; it is then where it was before.
  virtual Scan scan_at(const PlanarPose& goal) = 0;
  /// Raises or lowers the scanner for the scans that follow: metres above the floor, known exactly.
  virtual void raise_scanner(double height_m) = 0;
  /// Where the robot believes to be after the scans were registered: corrects its estimate.
  virtual void localize(const PlanarPose& pose) = 0;

  /// Takes hold of what is at a point (map frame, as the robot believes) and pulls it along the path that
  /// it gives, by at most `max_distance_m` of hand path.
  virtual PullResult pull(const Vector3d& believed_point, double max_distance_m) = 0;
  /// Closes again what was pulled open.
  virtual void close_all() = 0;

  /// What it takes to go on after an interruption, and back.
  virtual Json state() const = 0;
  virtual void restore(const Json& state) = 0;
};

}  // namespace loci::mapping
