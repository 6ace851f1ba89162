#pragma once

#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/supports.h"
#include "mapping/interpretation/walls.h"

namespace loci::mapping {

/// A floor or ceiling.
struct LevelPlane {
  double height = 0;  ///< median over scans, metres
  double sd = 0;      ///< of the scans' heights
  double area = 0;    ///< seen, m²
  size_t inliers = 0;
  std::vector<int> scans;
  Extent extent;  ///< in the room's axes
};

/// What was recognised in a room whose main directions are turned by `yaw` against the map.
struct RecognisedRoom {
  double yaw = 0;
  bool free_space = true;
  std::optional<LevelPlane> floor;
  std::optional<LevelPlane> ceiling;
  std::vector<VerticalPlane> walls;
  std::vector<Support> supports;
};

/// Names of walls: by the side of the room ("wall_north" is on the +y side), clockwise, further ones of a
/// side with _2, _3.
std::vector<std::string> wall_names(const RecognisedRoom& room);

/// Names of supports: class and number, numbered clockwise along the walls from the north-west corner, so
/// that the same kitchen scanned again gets the same names.
std::vector<std::string> support_names(const RecognisedRoom& room);

/// Writes the room as links (root "map") and their sidecar entries.
void add_links(const RecognisedRoom& room, const InterpretationOptions& options, InterpretedMap& map);

}  // namespace loci::mapping
