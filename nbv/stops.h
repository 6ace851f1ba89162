#pragma once

#include <vector>

#include "mapping/base/options.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/world/furniture.h"
#include "nbv/planner.h"

namespace loci::nbv {

struct StopOptions {
  double distance_min_m = 0.9;  ///< of the robot from the front that it looks at
  double distance_max_m = 1.8;
  double bearing_max_deg = 55;  ///< from the front's normal

  void declare(OptionTable& table);
};

/// Where the robot stands to pull at some fronts in turn: what it sees closed and open differs by nothing but
/// the part that moved.
struct InteractionStop {
  mapping::PlanarPose pose;
  std::vector<size_t> fronts;  ///< into the fronts that were asked for
};

/// Chooses where to stand for pulling, in space as it is known: reachable, near, not too oblique, with the
/// fixture and most of the front in sight, and out of the way of what opens.
class StopPlanner {
 public:
  /// `way_m`: how far fronts are pulled.
  StopPlanner(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
              const mapping::LaserModel& laser, const PlannerOptions& planner, const StopOptions& options,
              double way_m);

  /// Few stops for the fronts that have a fixture; those that cannot be seen from anywhere are in none.
  std::vector<InteractionStop> plan(const std::vector<mapping::Front>& fronts) const;
  /// The robot could not get there: no stop within its radius from now on.
  void avoid(const mapping::PlanarPose& pose) { planner_.avoid.emplace_back(pose.x, pose.y); }

 private:
  /// A place, and how well it shows each front that is to be pulled.
  struct Candidate {
    Vector2d place;
    std::vector<std::pair<size_t, double>> fronts;  ///< index and quality
  };
  std::vector<Vector2d> places() const;
  double quality(const mapping::Front& front, const Vector2d& place, const StopOptions& limits) const;
  std::vector<Candidate> candidates(const std::vector<mapping::Front>& fronts,
                                    const std::vector<bool>& served, const StopOptions& limits) const;

  mapping::Voxels voxels_;
  mapping::LaserModel laser_;
  PlannerOptions planner_;
  StopOptions options_;
  double way_;
  mapping::FloorGrid floor_;
  Reach reach_;
};

}  // namespace loci::nbv
