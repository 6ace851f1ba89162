#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/interpretation.h"
#include "nbv/exploration.h"
#include "nbv/stops.h"

namespace loci::nbv {

struct InteractionOptions {
  double pull_way_m = 0.30;  ///< how far the hand pulls
  StopOptions stops;
  mapping::DifferenceOptions difference;

  void declare(OptionTable& table);
};

/// What pulling at one front showed.
struct Interaction {
  std::string front;
  size_t stop = 0;
  bool held = false;  ///< whether the hand found something to hold
  mapping::DifferenceResult difference;
  double seconds = 0;
};

/// Pulls at every front of the explored region that has a fixture, scans again, and puts what the motion
/// shows (joint, rectangle, class) in the place of what was assumed. A fixture on which the hand closes in
/// vain is taken out, with its front where no seam shows one. Checkpoints in `folder`/interaction: on resume,
/// a front that was pulled is not pulled again.
std::vector<Interaction> interact(mapping::Robot& robot, const Exploration& exploration,
                                  std::vector<mapping::Front>& fronts, const std::filesystem::path& folder,
                                  bool resume, const ExplorationOptions& explored,
                                  const InteractionOptions& options, Progress& progress, Warnings& warnings);

}  // namespace loci::nbv
