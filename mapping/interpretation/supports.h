#pragma once

#include <array>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surface.h"
#include "mapping/interpretation/walls.h"

namespace loci::mapping {

/// A rectangle in the axes of its support: [min, max] in metres.
struct Extent {
  Vector2d min = Vector2d::Zero();
  Vector2d max = Vector2d::Zero();

  Vector2d size() const { return max - min; }
  Vector2d centre() const { return (min + max) / 2; }
  double area() const { return size().x() * size().y(); }
  /// Whether a point lies inside, grown by `margin`.
  bool contains(const Vector2d& point, double margin = 0) const {
    return (point.array() >= min.array() - margin).all() && (point.array() <= max.array() + margin).all();
  }
};

/// What ends a support at one side.
enum class EdgeKind {
  free,   ///< rays passed just outside
  wall,   ///< a wall is there
  front,  ///< a furniture face below ends there
  unseen  ///< nothing looked there, or something stands in the way
};
const char* edge_kind_name(EdgeKind kind);

/// A horizontal surface that things can stand on.
struct Support {
  double height = 0;  ///< median over scans, metres
  double yaw = 0;     ///< of its axes against the map's
  /// Rectangles that touch, the largest first; more than one where the surface goes round a corner.
  std::vector<Extent> parts;
  /// Outline where rectangles do not fit it, in the map, counter-clockwise; the first part is its box then.
  std::vector<Vector2d> polygon;
  double radius = 0;                ///< of a round one; 0 = not round
  std::array<EdgeKind, 4> edges{};  ///< of the first part: x min, x max, y min, y max
  double observed_area = 0;         ///< m² of surface that was seen inside the outline
  double pierced_area = 0;          ///< m² inside through which a ray passed: against it
  double seen_below = 0;            ///< fraction of its footprint under which rays passed at half its height
  double wall_distance = 1e9;       ///< of its nearest edge to the nearest wall it is parallel to, metres
  int wall = -1;                    ///< that wall
  bool behind_face = false;         ///< extent from a furniture face and a wall, not from its own surface
  double sd = 0;                    ///< of the heights of the scans, metres
  size_t inliers = 0;
  std::vector<int> scans;
  std::string class_name;
  std::string reason;  ///< of the class

  double area() const;
  Eigen::Rotation2Dd map_from_axes() const { return Eigen::Rotation2Dd(yaw); }
  /// Outline in the map, counter-clockwise.
  std::vector<Vector2d> outline() const;
};

struct SupportSearch {
  std::vector<Support> supports;
  std::vector<std::string> notes;  ///< what was left out and why
};

/// Horizontal surfaces between floor and support_max_height. Objects leave holes, glossy tops give few
/// points: the outline is the set of rectangles, aligned with the room or slightly turned against it, that
/// gathers most surface and least evidence against it (rays that passed through).
SupportSearch find_supports(const Surface& surface, double floor_height, double yaw,
                            const WallSearch& vertical, const InterpretationOptions& options,
                            Progress& progress);

}  // namespace loci::mapping
