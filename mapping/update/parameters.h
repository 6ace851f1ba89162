#pragma once

#include <cstddef>
#include <cstdint>

#include "mapping/base/math/math.h"
#include "mapping/world/free_standing.h"

namespace loci::mapping {

/// What is the same surface in two epochs.
struct EpochParameters {
  double cell_m = 0.025;            ///< of the surfels: half the leg of a table
  double coarse_m = 0.05;           ///< of the registration of all new scans
  double max_offset_m = 0.025;      ///< between planes of one surface: noise and registration
  float free_margin_m = 0.05F;      ///< a ray that goes on by less may have ended on the surface
  uint32_t min_points = 2;          ///< of a surfel that is no stray point
  float same_plane_cosine = 0.94F;  ///< 20 degrees between normals of one plane
  float same_plane_m = 0.015F;      ///< between neighbouring surfels of one plane
  double max_conflict = 0.5;        ///< furniture that moved is no reason to refuse
  double min_overlap = 0.5;         ///< of the smaller surface with the other: most of a room stays
};
inline constexpr EpochParameters kEpochs;

/// Free-standing pieces of furniture.
struct PieceParameters : FreeStandingParameters {
  double floor_m = 0.04;           ///< lower surfels are floor
  double top_m = 2.0;              ///< higher ones are lamps and ceilings
  double wall_m = 0.06;            ///< nearer to a wall's plane is the wall
  double outline_margin_m = 0.02;  ///< around a support's outline
  double slab_m = 0.05;            ///< below a support's height is its slab
  double inside_share = 0.85;      ///< of a component that stands within the outline of another
  size_t min_surfels = 40;         ///< about 0.025 m²
  double beside_m = 0.15;          ///< around a piece that begins above the floor …
  double level_m = 0.06;           ///< … and near the height of its bottom …
  size_t min_beside = 15;          ///< … surfels of another top: the piece lies on that
};
inline constexpr PieceParameters kPieces;

/// The search for the pose of a piece.
struct MotionParameters : FurnitureMotionParameters {
  double step_m = 0.05;             ///< of the grid of starting poses
  double turn_step = 6 * kDegree;   ///< radians
  double near_m = 0.4;              ///< of a search around the old place …
  double near_turn = 48 * kDegree;  ///< … radians
  double around_m = 0.25;           ///< of a search around another component
  double beside_m = 0.1;          ///< around a piece, where its surface would be if it lay a little otherwise
  size_t samples = 160;           ///< surfels of a piece per starting pose
  size_t interleave = 13;         ///< any prefix of the samples covers the piece
  double min_share_unseen = 0.5;  ///< as min_share, where the old place was not seen
  double as_good = 0.8;           ///< of a piece's found surfels: its old place shows it as well
  double min_kept = 0.9;          ///< of a piece's found surfels that another piece may leave it
};
inline constexpr MotionParameters kMotion;

/// Changes that are not motions.
struct ChangeParameters {
  double min_new_share = 0.6;        ///< of a component that the map does not explain
  double min_free_share = 0.3;       ///< of it in space that was free: it came
  double front_gap_m = 0.03;         ///< around a front's rectangle
  double min_front_open = 0.4;       ///< of a closed front's surface that is not there any more
  double min_front_through = 0.25;   ///< of a closed door's surface that rays pass when it is open
  double swept_margin_m = 0.1;       ///< around what a front may sweep
  double leaf_m = 0.02;              ///< thickness of an open door
  double leaf_step_m = 0.02;         ///< between tried places of its far edge: less than a surfel …
  double min_leaf_m = 0.1;           ///< … from where it is clear of its closed place
  double leaf_cell_m = 0.05;         ///< of a panel, two surfels: …
  double min_leaf_share = 0.5;       ///< … so much of it is seen where the joint takes it, …
  double min_edge_share = 0.06;      ///< … or so much, where rays passed its closed place
  size_t min_scan_points = 30;       ///< of a scan that shows a change
  double known_piece_m = 0.15;       ///< a piece of the sidecar so near is the same one
  double refresh_confidence = 0.02;  ///< a link that is known by so much better is written anew
};
inline constexpr ChangeParameters kChanges;

}  // namespace loci::mapping
