#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/interpretation.h"
#include "nbv/base_poses.h"
#include "nbv/exploration.h"

namespace loci::nbv {

struct InteractionOptions {
  double pull_distance_m = 0.30;  ///< how far the hand pulls
  BasePoseOptions base_poses;
  mapping::DifferenceOptions difference;

  void declare(OptionTable& table);
};

/// Result of pulling one front.
struct Interaction {
  std::string pulled_as;             ///< name of the front when it was pulled, as in `interaction/`
  std::optional<std::string> front;  ///< its name in the map; unset where what was pulled is not a front
  size_t base_pose = 0;              ///< number of the pose that it was pulled from
  bool held = false;                 ///< whether the hand found something to hold
  bool blocked = false;              ///< whether it moved, but could not be scanned open
  mapping::DifferenceResult difference;
  double seconds = 0;
};

/// Pulls at every front of the explored region that has a fixture, scans again, and puts what the motion
/// shows (joint, rectangle, class) in the place of what was assumed. A fixture on which the hand closes in
/// vain is taken out, with its front where no seam shows one. Fronts whose bars are in line and that come out
/// together are one drawer. The fronts keep the names under which they were pulled. Checkpoints in
/// `folder`/interaction: on resume, a front that was pulled is not pulled again.
std::vector<Interaction> interact(mapping::Robot& robot, const Exploration& exploration,
                                  std::vector<mapping::Front>& fronts, const std::filesystem::path& folder,
                                  bool resume, const ExplorationOptions& explored,
                                  const InteractionOptions& options, Progress& progress, Warnings& warnings);

}  // namespace loci::nbv
