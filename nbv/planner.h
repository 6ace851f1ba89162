#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/options.h"
#include "mapping/base/text/json.h"
#include "mapping/occupancy/floor_grid.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/laser.h"
#include "nbv/costmaps.h"
#include "nbv/frontier.h"
#include "nbv/ray_casting.h"
#include "nbv/reachability.h"

namespace loci::nbv {

struct PlannerOptions {
  double cell_m = 0.10;
  int orientations = 8;
  double min_distance_m = 1.0;
  double max_distance_m = 4.0;
  double opening_deg = 180;
  double robot_radius_m = 0.30;
  double overlap_wanted = 0.5;
  double min_view_overlap = 0;  ///< views with less are not chosen
  double gain_weight = 0.75;    ///< 0.5 is the paper's score
  int samples = 64;             ///< at most, and one per 0.1 m² where the robot can stand
  double ray_step_deg = 1;
  double travel_cost_per_m = 0;
  double min_gain = 0.2;
  std::string within = {};  ///< mapping::FloorRegion that is explored and driven in
  /// Positions that the robot failed to reach: nothing within its radius of them is chosen.
  std::vector<Vector2d> avoid = {};
  std::vector<double> heights = {};  ///< of the scanner; empty: as it is carried alone. Not declared
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);
};

/// The next view and the reason for it.
struct NextView {
  std::optional<mapping::PlanarPose> pose;  ///< unset: stop
  std::optional<double> height_m;           ///< of the scanner there; unset: as it is carried
  std::string reason;                       ///< of the stop, or of the choice
  double expected_overlap = 0;              ///< n_o / (n_o + n_f) of the validated view
  double expected_gain = 0;                 ///< what may be seen anew behind the frontier, m²
  size_t frontier_voxels = 0;               ///< in the whole map
  std::vector<mapping::PlanarPose> path;    ///< corners of the path on the floor, the pose last
  Json details;                             ///< samples with scores, times, stopping measures
};

/// A pose that was validated by casting its rays.
struct ViewSample {
  mapping::PlanarPose pose;
  double cost_value = 0;  ///< c of the costmap
  ViewCounts counts;
  double score = 0;
};

/// Inputs and intermediate results of a decision, for images and reports.
struct ViewPlan {
  NextView view;
  mapping::Voxels voxels;
  ViewVoxels frontier;
  mapping::FloorGrid floor;
  Reachability reach;
  CostmapStack frontier_costs;  ///< C_F
  CostmapStack occupied_costs;  ///< C_O
  CostmapStack costs;           ///< C = min(C_F, C_O) where the robot can stand, 0 elsewhere
  std::vector<ViewSample> samples;
};

/// Whether a position is within the robot's radius of one that it failed to reach.
bool avoided(const Vector2d& place, const PlannerOptions& options);

/// Height of the robot that carries the scanner, metres; lower obstacles block it.
double body_height(const mapping::LaserModel& laser);

/// The floor as the planner sees it: that of the voxels, and that on which the robot stands now; without what
/// lies outside `options.within`.
mapping::FloorGrid drivable_floor(const mapping::Voxels& voxels, const mapping::PlanarPose& robot,
                                  const mapping::LaserModel& laser, const PlannerOptions& options);
/// Where the robot can drive to on it.
Reachability reachability(const mapping::FloorGrid& floor, const mapping::PlanarPose& robot,
                          const PlannerOptions& options);

/// Next best view by costmaps (§7.3.1): frontier and occupied voxels vote through a visibility kernel per
/// orientation for planar poses; places sampled in proportion to C = min(C_F, C_O) are validated by ray
/// casting with the sensor's model, in all orientations at once, and scored by c · H(n_o, n_f). With
/// gain_weight other than 0.5 the score is the geometric mean between that and n_o alone (0) or n_f alone
/// (1). Poses that the robot cannot drive to, or where no floor was seen, are not candidates. The height of
/// the scanner is then chosen by the same score at that pose. The map's floor is at z = 0. Same seed, same
/// plan, on any number of threads.
ViewPlan plan_view(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                   const mapping::LaserModel& laser, const PlannerOptions& options, const Random& random);

/// The decision alone.
NextView next_view(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                   const mapping::LaserModel& laser, const PlannerOptions& options, const Random& random);

/// The choice among recorded scans.
struct PoolChoice {
  NextView view;
  std::optional<size_t> index;  ///< of the chosen pose; unset: stop
};

/// Which of the given poses to take next: a pool of recorded scans, where paths do not matter. Each pose is
/// validated and scored like a sample of plan_view().
PoolChoice choose_view(const mapping::OccupancyMap& map, const std::vector<mapping::PlanarPose>& poses,
                       const mapping::LaserModel& laser, const PlannerOptions& options);

}  // namespace loci::nbv
