#pragma once

#include <vector>

#include "mapping/base/options.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/world/furniture.h"
#include "nbv/planner.h"

namespace loci::nbv {

struct BasePoseOptions {
  double min_distance_m = 0.9;  ///< of the robot from the front that it looks at
  double max_distance_m = 1.8;
  double max_bearing_deg = 55;  ///< from the front's normal

  void declare(OptionTable& table);
};

/// A pose of the robot's base from which it pulls some fronts in turn. The scans before and after a pull
/// differ only in the part that moved.
struct BasePose {
  mapping::PlanarPose pose;
  std::vector<size_t> fronts;  ///< indices into the fronts of plan()
};

/// Chooses base poses for pulling fronts: reachable, near, not too oblique, with the fixture and most of the
/// front in sight, and clear of the part that opens.
class BasePosePlanner {
 public:
  /// `pull_distance_m`: how far fronts are pulled.
  BasePosePlanner(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                  const mapping::LaserModel& laser, const PlannerOptions& planner,
                  const BasePoseOptions& options, double pull_distance_m);

  /// A small set of poses for the fronts that have a fixture; fronts that no pose shows are left out.
  std::vector<BasePose> plan(const std::vector<mapping::Front>& fronts) const;
  /// Excludes poses within the robot's radius of one that it could not reach.
  void avoid(const mapping::PlanarPose& pose) { planner_.avoid.emplace_back(pose.x, pose.y); }

 private:
  /// A position and the quality with which it shows each front.
  struct Candidate {
    Vector2d place;
    std::vector<std::pair<size_t, double>> fronts;  ///< index and quality
  };
  std::vector<Vector2d> places() const;
  double quality(const mapping::Front& front, const Vector2d& place, const BasePoseOptions& limits) const;
  std::vector<Candidate> candidates(const std::vector<mapping::Front>& fronts,
                                    const std::vector<bool>& served, const BasePoseOptions& limits) const;

  mapping::Voxels voxels_;
  mapping::LaserModel laser_;
  PlannerOptions planner_;
  BasePoseOptions options_;
  double pull_distance_;
  mapping::FloorGrid floor_;
  Reachability reach_;
};

}  // namespace loci::nbv
