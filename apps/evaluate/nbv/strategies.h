#pragma once

#include <functional>
#include <string>
#include <vector>

#include "nbv/planner.h"

namespace loci::apps::nbv_evaluation {

/// A decision of any planner.
struct Decision {
  std::optional<mapping::PlanarPose> pose;  ///< unset: stop
  double seconds = 0;                       ///< that it took, or would have taken without the limit
  double cpu_seconds = 0;                   ///< likewise, of all threads: other programs do not count
  bool cut = false;                         ///< by the time limit
  double overlap = 0;                       ///< expected
};

using Strategy = std::function<Decision(const mapping::OccupancyMap&, const mapping::PlanarPose&, Random&)>;

struct NamedStrategy {
  std::string name;
  Strategy decide;
};

/// Names of all strategies, in the order in which they are run.
std::vector<std::string> planner_names();

/// Ours; a random reachable pose; the nearest frontier (Yamauchi 1997); and the exhaustive greedy planner,
/// which casts all rays from each reachable cell, with our ray caster over the same voxels, and takes the
/// largest gain of any orientation (orientations share rays: it does no work twice). It is cut after
/// `exhaustive_s` seconds per decision: places are taken in random order, and its time is then that of all of
/// them by rule of three. All see the same map, floor and ways,
/// and stop alike: when no pose is left or, where a gain is known, at options.min_gain.
std::vector<NamedStrategy> strategies(const mapping::LaserModel& laser, const nbv::PlannerOptions& options,
                                      double exhaustive_s);

}  // namespace loci::apps::nbv_evaluation
