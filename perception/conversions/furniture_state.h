#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::perception {

/// How a piece of the map's furniture stands, as far as a run has found out.
struct FurnitureState {
  std::string name;
  bool moved = false;                 ///< it is not where the map has it
  bool found = true;                  ///< where it stands is known
  Vector2d shift = Vector2d::Zero();  ///< of its middle, map frame, metres
  double turn = 0;                    ///< about its middle, radians
  double log_odds = 0;                ///< that it has left where it is believed to stand
};

/// What an earlier run, or an interrupted one, found out. A resource of the pipeline.
struct FurnitureStates {
  std::vector<FurnitureState> pieces;
};

}  // namespace loci::perception
