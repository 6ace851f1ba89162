#pragma once

namespace loci::mapping {

/// Sizes that scans do not show, and the order of names.
struct FurnitureParameters {
  double panel_m = 0.02;               ///< thickness of fronts
  double board_m = 0.012;              ///< of a drawer's sides and bottom
  double runner_m = 0.019;             ///< between a drawer's side and the edge of its front
  double min_drawer_m = 0.05;          ///< depth of the shallowest drawer
  double post_inset = 0.15;            ///< of a bar's length, position of its posts
  double wall_m = 0.05;                ///< thickness of walls, floor and ceiling
  double min_wall_part_m = 0.02;       ///< less between two openings is noise of their edges
  double strip_m = 0.05;               ///< of the boxes that approximate a polygon
  double max_fixed_probability = 0.5;  ///< of a front without fixture that opens, as fronts do
  double neighbour_odds = 4;           ///< that a front without fixture opens as equal neighbours suggest
  double row_m = 0.3;                  ///< faces less far behind each other are one row of furniture
  double column_m = 0.1;               ///< between the left edges of fronts of one column
  double gap_m = 0.003;                ///< between fronts, and between a front and what is beside it
  double max_cut = 0.35;               ///< of a panel's width or height, to make room for others
  double max_planing_m = 0.015;        ///< of a panel's side, to slide past what stands beside it
  double hinge_m = 0.03;               ///< how far off a panel's edge a hinge may be found
  double max_hinge_behind_m = 0.002;   ///< the face; from farther behind, a door turns into its neighbour
  double min_slide_m = 0.02;           ///< shorter ranges are errors of the map, not limits of joints
  double min_turn = 0.1;               ///< radians, likewise
  double min_slab_m = 0.01;            ///< thickness of the thinnest slab
  double min_rest_m = 0.002;           ///< sides of the smallest box that a cut leaves
  double wood_density = 600;           ///< kg/m³
  double steel_density = 7800;         ///< kg/m³
};
inline constexpr FurnitureParameters kFurniture;

/// Bodies of furniture behind fronts.
struct CabinetParameters {
  double board_m = 0.016;     ///< usual chipboard; runners leave 19 mm beside a drawer
  double aligned_m = 0.025;   ///< between edges of fronts of one body: the error of both
  double max_cover_m = 0.15;  ///< between fronts of one body: a panel that does not open
  double same_face_m = 0.02;  ///< between the planes of such fronts: a panel's thickness
  double parallel_cosine = 0.999;
  double max_wing_m = 0.62;    ///< of the wider door of a pair: cupboards are up to 1.2 m wide
  double max_lean = 0.1;       ///< of a front's normal; other fronts have no body
  double min_depth_m = 0.2;    ///< of shallow upper cabinets …
  double max_depth_m = 0.9;    ///< … and of deep islands: no wall farther behind ends a body
  double assumed_depth = 0.7;  ///< factor on the confidence
  double clearance_m = 0.001;  ///< to everything else, so that rounding makes no contact
};
inline constexpr CabinetParameters kCabinets;

/// Doors that slide past each other.
struct SlidingParameters {
  double min_step_m = 0.015;     ///< between their planes: the thinnest panel …
  double max_step_m = 0.055;     ///< … and two rails beside each other
  double min_width_ratio = 0.7;  ///< equal panels, of which the rear one is covered in part
  double probability = 0.7;      ///< an appliance stands out from a row of its height, too
};
inline constexpr SlidingParameters kSliding;

}  // namespace loci::mapping
