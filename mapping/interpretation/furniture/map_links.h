#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/supports/supports.h"
#include "mapping/interpretation/surfaces/levelling.h"
#include "mapping/interpretation/surfaces/openings.h"
#include "mapping/interpretation/surfaces/walls.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A floor or ceiling.
struct LevelPlane : LevelHeight {
  double area = 0;  ///< seen, m²
  size_t inliers = 0;
  Extent extent;  ///< in the room's axes
};

/// What was recognised in a room; `yaw`: of its main directions in the map.
struct RecognisedRoom {
  double yaw = 0;
  bool free_space = true;
  std::optional<LevelPlane> floor;
  std::optional<LevelPlane> ceiling;
  std::vector<VerticalPlane> walls;
  std::vector<std::vector<WallOpening>> openings;  ///< of each wall
  std::vector<Support> supports;
};

/// Writes the room as links (root "map") and their sidecar entries.
void add_links(const RecognisedRoom& room, const InterpretationOptions& options, InterpretedMap& map);

/// Adds fronts with links, joints and classes by their shape and neighbours (set_prior_joint(),
/// follow_neighbours()) and names by class and number.
void add_fronts(const RecognisedRoom& room, std::vector<Front> fronts, InterpretedMap& map);

/// Replaces the map's fronts by updated ones (joint, class, rectangle), named again. Returns the new name of
/// each front that came with one.
std::map<std::string, std::string> replace_fronts(std::vector<Front> fronts, InterpretedMap& map);

}  // namespace loci::mapping
