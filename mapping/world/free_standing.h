#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"

namespace loci::mapping {

/// Which furniture people move: it stands free on the floor.
struct FreeStandingParameters {
  double link_m = 0.05;          ///< cells that touch are one component
  double on_top_m = 0.5;         ///< what stands on a support belongs to it up to this height
  double below_margin_m = 0.05;  ///< sides that were hidden are missing from an outline …
  double below_share = 0.75;     ///< … of a component that carries the support
  double stands_m = 0.3;         ///< a piece that begins higher …
  double hanging_wall_m = 0.2;   ///< … and so near to a wall is fixed to it
  double max_extent_m = 2.6;     ///< wider is a row of cabinets
  double min_extent_m = 0.15;    ///< smaller is an object on the floor
  double min_top_m = 0.18;       ///< lower is a rug or a threshold
  double beside_wall_m = 0.12;   ///< furniture so near to a wall …
  double fixed_width_m = 0.9;    ///< … along so much of it …
  double fixed_height_m = 1.5;   ///< … or so high does not move
};
inline constexpr FreeStandingParameters kFreeStanding;

/// When a pose of furniture is better than where the map has it.
struct FurnitureMotionParameters {
  double min_move_m = 0.04;          ///< furniture that moved less …
  double min_move_deg = 2.5;         ///< … and turned less has not moved
  size_t first_samples = 24;         ///< of a starting pose, after which …
  double min_first_score = 3;        ///< … a worse one is dropped
  size_t starts = 16;                ///< that are refined per search
  double apart_m = 0.1;              ///< starts that are nearer descend to the same pose …
  double apart_turn = 12 * kDegree;  ///< … and less turned
  double min_share = 0.2;            ///< of a piece's surface that must be found again
  double min_agreement = 0.7;        ///< found over found and contradicted
  double min_gain = 0.06;            ///< of a piece's surface: found more than at its old place
  size_t min_gain_surfels = 15;
  double cost_per_m = 0.12;     ///< of a piece's surface: of two poses the nearer one, up to 1 m …
  double cost_per_turn = 0.05;  ///< … and per half turn: shapes that look the same rotated
  double left_share = 0.5;      ///< of what can be seen that must be contradicted: the place is empty
  double correlated = 6;        ///< surfels that see the same error
  double prior_log_odds = -2;   ///< that a piece moved between two visits
};
inline constexpr FurnitureMotionParameters kFurnitureMotion;

/// A piece of a wall's plane. Map frame, metres.
struct WallRectangle {
  Vector2d normal = Vector2d::UnitX();
  double offset = 0, along_min = 0, along_max = 0, bottom = 0, top = 0;
  /// Whether a point is within `margin` of the wall's plane and beside its rectangle.
  bool near(const Eigen::Vector3f& point, double margin) const;
};

/// Whether a piece of furniture with these points of its surface (map frame) can be moved: neither a rug nor
/// a row of cabinets, and not built in along a wall. `may_hang`: it may be fixed to a wall above the floor.
bool stands_free(const std::vector<Eigen::Vector3f>& points, const std::vector<WallRectangle>& walls,
                 bool may_hang);

/// Whether a motion of furniture is one that is reported, seen at a point of it (map frame).
bool is_furniture_motion(const Isometry3d& now_from_before, const Vector3d& point);

}  // namespace loci::mapping
