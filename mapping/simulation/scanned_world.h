#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/sensor/laser.h"
#include "mapping/world/world.h"

namespace loci {

class RayScene;

struct ScannedWorldOptions {
  std::vector<std::filesystem::path> package_paths = {};  ///< where package:// is looked for
  std::optional<double> floor = 0;                        ///< height of a floor to add; unset = none
  std::optional<double> ceiling;                          ///< height of a ceiling to add
  LaserModel laser;
  OdometryModel odometry;
  uint64_t seed = 1;
  int threads = 0;
};

/// What pulling at a point of the world did.
struct PullResult {
  std::string link;   ///< that was taken hold of; empty = nothing is there
  std::string joint;  ///< that gave way; empty = it did not move
  double moved = 0;   ///< metres or radians
  Isometry3d map_from_link_before = Isometry3d::Identity();
  std::vector<Isometry3d> hand_path;  ///< true poses of the gripper on the way, map frame, first = closed
};

/// A simulated kitchen with a robot in it that scans (sensor of DESIGN §4) and pulls handles. The map's frame
/// is the world's; the first pose is exact, every later one drifts until localize().
class ScannedWorld : public Scanner {
 public:
  ScannedWorld(const std::filesystem::path& urdf, const ScannedWorldOptions& options, const PlanarPose& start,
               Warnings& warnings);
  ~ScannedWorld() override;

  Scan scan_at(const PlanarPose& goal) override;
  void localize(const PlanarPose& pose) override;

  /// Takes hold of what is within 5 cm of a point that the robot believes in (its pose error applies) and
  /// pulls it along the compliant path of its joint by at most `way` metres of hand path.
  PullResult pull(const Vector3d& believed_point, double way);
  /// Closes everything.
  void close_all();

  // Truth, for evaluation only.
  PlanarPose true_pose() const;
  const World& world() const;
  const JointState& joints() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One noisy sweep from a true pose: points in the scanner frame, one per ray (no return = range_max), rays
/// nearer than range_min left out. Same seed, same bytes on any number of threads.
Scan simulate_sweep(const RayScene& scene, const Isometry3d& map_from_scanner, const LaserModel& laser,
                    const Random& random, int threads);

}  // namespace loci
