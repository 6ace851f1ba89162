#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surface.h"

namespace loci::mapping {

/// A vertical plane: normal · (x, y) = offset, with the rectangle in which it was seen.
struct VerticalPlane {
  Vector2d normal = Vector2d::UnitX();  ///< towards the side it was seen from
  double offset = 0;
  double along_min = 0, along_max = 0;  ///< along (-normal.y, normal.x), metres
  double bottom = 0, top = 0;           ///< z
  double area = 0;                      ///< seen, m²
  double sd = 0;                        ///< of the distances of its points, metres
  double behind = 0;                    ///< fraction of its length that has something seen behind it
  size_t inliers = 0;
  std::vector<int> scans;

  Vector2d direction() const { return {-normal.y(), normal.x()}; }
  double length() const { return along_max - along_min; }
  /// A point of the plane at a position along it.
  Vector2d at(double along) const { return offset * normal + along * direction(); }
};

struct WallSearch {
  std::vector<VerticalPlane> walls;
  std::vector<VerticalPlane> others;  ///< large vertical planes that are no walls: furniture faces
  std::vector<std::string> notes;     ///< why not
};

/// Large vertical planes; a wall is one that goes up as far as the room does (§7.4: adjacent to the ceiling,
/// where it is known; otherwise nothing was seen over it), and through which few rays passed. Pieces of one
/// wall beside doors and windows are united; panes, reveals and tall furniture are no walls.
WallSearch find_walls(const Surface& surface, double floor_height, std::optional<double> ceiling_height,
                      const InterpretationOptions& options);

}  // namespace loci::mapping
