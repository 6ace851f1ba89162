#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surfaces/vertical_planes.h"

namespace loci::mapping {

struct WallSearch {
  std::vector<VerticalPlane> walls;
  std::vector<VerticalPlane> others;  ///< other large vertical planes: furniture faces
  std::vector<std::string> notes;     ///< the reason for each of the others
};

/// Separates large vertical planes into walls and others. A wall reaches the ceiling (§7.4), or nothing was
/// seen over it where the ceiling is unknown, and few rays passed through it. Pieces of a wall beside doors
/// and windows are united; window panes, reveals and tall furniture are no walls.
WallSearch find_walls(const Surface& surface, double floor_height, std::optional<double> ceiling_height,
                      const InterpretationOptions& options);

/// The yaw of the walls that agree with a rough one of the room modulo quarter turns; that one without any.
double yaw_of_walls(const std::vector<VerticalPlane>& walls, double rough_yaw);

}  // namespace loci::mapping
