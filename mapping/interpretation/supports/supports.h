#pragma once

#include <array>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surfaces/surface.h"
#include "mapping/interpretation/surfaces/walls.h"

namespace loci::mapping {

/// A rectangle in the axes of its support: [min, max] in metres.
struct Extent {
  Vector2d min = Vector2d::Zero();
  Vector2d max = Vector2d::Zero();

  /// An extent without points, to be extended.
  static Extent empty() { return {Vector2d::Constant(1e9), Vector2d::Constant(-1e9)}; }
  void extend(const Vector2d& point) { min = min.cwiseMin(point), max = max.cwiseMax(point); }
  void extend(const Extent& other) { extend(other.min), extend(other.max); }
  Vector2d size() const { return max - min; }
  Vector2d centre() const { return (min + max) / 2; }
  double area() const { return size().x() * size().y(); }
  /// Whether a point lies inside, grown by `margin`.
  bool contains(const Vector2d& point, double margin = 0) const {
    return (point.array() >= min.array() - margin).all() && (point.array() <= max.array() + margin).all();
  }
};

/// What bounds a support at one side.
enum class EdgeKind {
  free,   ///< rays passed just outside
  wall,   ///< a wall
  front,  ///< a furniture face below
  unseen  ///< not observed or occluded
};
const char* edge_kind_name(EdgeKind kind);

/// A leg or the pedestal of a table.
struct Leg {
  Extent footprint;  ///< in the table's axes
  size_t inliers = 0;
};

/// A horizontal surface that objects can stand on.
struct Support {
  double height = 0;  ///< median over scans, metres
  double yaw = 0;     ///< of its axes against the map's
  /// Rectangles that touch, largest first; several where the surface goes round a corner.
  std::vector<Extent> parts;
  /// Outline in the map, counter-clockwise, where rectangles do not fit; then the only part is its box.
  std::vector<Vector2d> polygon;
  double radius = 0;                ///< of a round one; 0 = not round
  std::array<EdgeKind, 4> edges{};  ///< of the first part: x min, x max, y min, y max
  double observed_area = 0;         ///< m² of surface seen inside the outline
  double pierced_area = 0;          ///< m² inside through which rays passed: evidence against it
  double seen_below = 0;            ///< fraction of the footprint under which rays passed at half its height
  double wall_distance = 1e9;       ///< of the nearest edge to the nearest parallel wall, metres
  int wall = -1;                    ///< that wall
  bool behind_face = false;         ///< extent from a furniture face and a wall, not from the surface itself
  double sd = 0;                    ///< of the heights of the scans, metres
  size_t inliers = 0;
  std::vector<int> scans;
  std::vector<Leg> legs;  ///< of a table
  std::string class_name;
  std::string reason;  ///< of the class

  double area() const;
  Eigen::Rotation2Dd map_from_axes() const { return Eigen::Rotation2Dd(yaw); }
  /// Whether a point of the map, grown by `margin`, lies within a part.
  bool contains(const Vector2d& map_point, double margin = 0) const;
  /// Outline in the map, counter-clockwise.
  std::vector<Vector2d> outline() const;
};

struct SupportSearch {
  std::vector<Support> supports;
  std::vector<std::string> notes;  ///< what was left out and why
};

/// Horizontal surfaces between floor and max_support_height_m. As objects leave holes and glossy tops give
/// few points, the outline is the set of rectangles, along its own edges or the walls, with the
/// highest score: surface that was seen, minus rays that passed through.
SupportSearch find_supports(const Surface& surface, double floor_height, double yaw,
                            const WallSearch& vertical, const InterpretationOptions& options,
                            Progress& progress);

}  // namespace loci::mapping
