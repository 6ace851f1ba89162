#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/interpretation.h"
#include "nbv/exploration.h"

namespace loci {

struct InteractionOptions {
  double pull_way_m = 0.30;     ///< how far the hand pulls
  double distance_min_m = 0.9;  ///< of the robot from the front that it looks at
  double distance_max_m = 1.8;
  double bearing_max_deg = 55;  ///< from the front's normal
  DifferenceOptions difference;

  void declare(OptionTable& table);
};

/// Where the robot stands to pull at some fronts in turn: what it sees closed and open differs by nothing but
/// the part that moved.
struct InteractionStop {
  PlanarPose pose;
  std::vector<size_t> fronts;  ///< into the fronts that were asked for
};

/// What pulling at one front showed.
struct Interaction {
  std::string front;
  size_t stop = 0;
  bool held = false;  ///< whether the hand found something to hold
  DifferenceResult difference;
  double seconds = 0;
};

/// Few stops from which every front with a fixture is seen well: reachable, near, not too oblique. Fronts
/// that cannot be seen from anywhere are in no stop.
std::vector<InteractionStop> plan_stops(const std::vector<Front>& fronts, const OccupancyMap& map,
                                        const PlanarPose& robot, const PlannerOptions& planner,
                                        const InteractionOptions& options);

/// Pulls at every front that has a fixture, scans again, and puts what the motion shows (joint, rectangle,
/// class) in the place of what was assumed; a fixture on which the hand closes in vain is taken out.
/// Checkpoints in `folder`/interaction: on resume, a front that was pulled is not pulled again.
std::vector<Interaction> interact(Robot& robot, const Exploration& exploration, std::vector<Front>& fronts,
                                  const std::filesystem::path& folder, bool resume,
                                  const PlannerOptions& planner, const InteractionOptions& options,
                                  Progress& progress, Warnings& warnings);

}  // namespace loci
