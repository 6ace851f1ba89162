#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/sensor/robot.h"
#include "mapping/simulation/laser_sweep.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Noise of an arm's forward kinematics.
struct HandModel {
  double position_sigma_m = 0.001;     ///< per direction and pose
  double orientation_sigma_deg = 0.3;  ///< about each direction
};

struct SimulatedRobotOptions {
  std::vector<std::filesystem::path> package_paths = {};  ///< where package:// is looked for
  /// Heights of the floor, on which the robot stands (at 0 where unset), and of the ceiling in the world's
  /// frame. A world without a link of that name gets one there, as large as the world; unset = none.
  std::optional<double> floor = 0, ceiling;
  LaserModel laser;
  OdometryModel odometry;
  HandModel hand;
  uint64_t seed = 1;
  int threads = 0;
};

/// The height at which a robot finds the floor of a world by what people ask for: a number, "none" (no floor
/// is added; it stands at 0), or "auto": that of the world's own floor, 0 where there is none or it lies
/// about there. Warns where nothing shows it and the world reaches below 0.
std::optional<double> floor_of_world(const std::string& asked, const std::filesystem::path& urdf,
                                     const std::vector<std::filesystem::path>& package_paths,
                                     Warnings& warnings);

/// A robot in a simulated kitchen that scans and pulls handles. The map frame is the world's with the floor
/// at z = 0; the first pose is exact, later ones drift until localize().
class SimulatedRobot : public Robot {
 public:
  SimulatedRobot(const std::filesystem::path& urdf, const SimulatedRobotOptions& options,
                 const PlanarPose& start, Warnings& warnings);
  ~SimulatedRobot() override;

  /// The robot ends beside the goal by what its odometry mis-measured on the way, and believes to be there.
  /// The covariance says how far off that may be since the start or the last localize(). Error, with the
  /// robot still where it was, when it would stand in the furniture: a disc of 25 cm radius between 5 cm and
  /// 1.3 m height, or 5 cm above a raised scanner, must be free. The way there is not looked at.
  Scan scan_at(const PlanarPose& goal) override;
  void raise_scanner(double height_m) override;
  void localize(const PlanarPose& pose) override;

  /// Takes hold of the surface that is nearest to a point that the robot believes in (its pose error applies,
  /// nothing beyond 5 cm is reached) and pulls it along the compliant path of its joint by at most
  /// `max_distance_m` metres of hand path, whose poses are measured as HandModel says. The joint is the
  /// nearest one above the link that moves; pulling at one that mimics moves the one that it mimics. It opens
  /// away from zero, or towards the robot where both ways are free, and no farther than its limits.
  PullResult pull(const Vector3d& believed_point, double max_distance_m) override;
  /// Moves joints of the world by hand, the others stay; Error for a joint that the world does not have or a
  /// position beyond its limits.
  void set_joints(const JointState& state);
  /// Closes everything.
  void close_all() override;

  /// The true and the believed pose, the scanner's height, the joints, how many scans and pulls were made.
  Json state() const override;
  void restore(const Json& state) override;

  /// Sets the true and the believed pose; for the start.
  void put_at(const PlanarPose& pose);
  /// The middle of the most open floor inside the world, or beside furniture without walls: a place to start
  /// from.
  PlanarPose open_place() const;

  /// From the frame of the URDF to the map's: down by the height of the floor.
  const Isometry3d& map_from_world() const;

  // Truth, for evaluation only.
  PlanarPose true_pose() const;
  Isometry3d true_map_from_scanner() const;
  const World& world() const;
  const RayScene& scene() const;  ///< with the floor and ceiling that were added
  const JointState& joints() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::mapping
