#pragma once

#include <array>
#include <cstddef>

namespace loci::mapping {

/// Normals of measured points.
struct NormalParameters {
  /// For ranges below 1.8 m, below 3 m and beyond: wide compared with a depth camera's noise.
  std::array<double, 3> cell_sizes_m = {0.02, 0.04, 0.08};
  double min_neighbours = 12;  ///< a plane fit over fewer points follows their noise
};
inline constexpr NormalParameters kNormals;

/// Scans that are upside down.
struct ScanCheckParameters {
  float level_cosine = 0.94F;    ///< horizontal within 20 degrees: noisy normals included
  float min_height_m = 0.25F;    ///< floors and ceilings look the same upside down
  float max_height_m = 2.3F;     ///< below the lowest ceilings
  size_t underside_ratio = 5;    ///< undersides per top; furniture upside down has hardly any tops
  size_t min_undersides = 1500;  ///< points; one hanging cabinet gives fewer
  double same_place_m = 0.1;     ///< between what two scans saw of one surface
};
inline constexpr ScanCheckParameters kScanCheck;

/// Floor, ceiling, and the levelling by the floor.
struct LevelParameters {
  double floor_reach_m = 0.25;  ///< a levelled input has its floor within this of z = 0
  double min_ceiling_m = 1.9;   ///< no habitable ceiling is lower
  double min_area_m2 = 0.3;     ///< less floor may be a step or a box
  double area_cell_m = 0.05;    ///< resolution of the area that was seen
  double height_bin_m = 0.01;   ///< of the height histogram; below a depth camera's noise
  double bin_m = 0.02;          ///< of heights along a possible floor normal
  size_t yaw_bins = 180;        ///< over 90 degrees: half a degree each
  double wall_yaw = 0.035;      ///< radians, between the room's rough yaw and a wall along it
};
inline constexpr LevelParameters kLevels;

/// Whether the level plane that fills the view is a floor or the top of a table.
struct GroundParameters {
  double on_plane_m = 0.03;       ///< a depth camera's noise and drift
  double min_drop_m = 0.15;       ///< below a top; steps, plinths and noise far away are lower
  double min_drop_share = 0.02;   ///< of the points: fewer may be wrong
  double max_length_m = 3;        ///< of tables
  double max_width_m = 1.6;       ///< of tables
  double max_camera_m = 1.2;      ///< over a table: eyes are 1.7 m over the floor, and tables 0.5 m or more
  double high_m = 0.3;            ///< little on a table is higher
  double min_high_share = 0.2;    ///< of the points, that furniture and walls beside a floor have
  size_t min_floor_points = 200;  ///< about 0.1 m² at the resolution of fused scans
  double min_floor_share = 0.3;   ///< of what faces up below a top
};
inline constexpr GroundParameters kGround;

/// Vertical planes, and which of them are walls.
struct WallParameters {
  double surfel_m = 0.03;            ///< points are thinned to these before planes are sought
  double area_cell_m = 0.05;         ///< resolution of the area that was seen
  double offset_bin_m = 0.03;        ///< of the Hough votes: depth camera noise at 3 m
  int angle_bins = 120;              ///< of the Hough votes: 3 degrees each
  int angle_spread_bins = 2;         ///< a surfel's normal is known within 6 degrees
  double min_facing_cosine = 0.94;   ///< 20 degrees between a surfel's normal and its plane's
  double same_wall_m = 0.07;         ///< noise, drift and posters make parallel layers this near
  double max_gap_m = 0.6;            ///< wider gaps split a plane into pieces
  size_t max_planes = 60;            ///< more than any room has; bounds the time
  double ray_cell_m = 0.1;           ///< cells in which rays are counted
  double on_plane_m = 0.05;          ///< a ray that ends this near ends on the plane
  double crossed_m = 0.12;           ///< a ray that ends this far behind has crossed it
  double above_top_m = 0.05;         ///< nearer to the top may still be the plane
  double max_above_top_m = 0.8;      ///< higher crossings do not concern the plane
  int min_rays = 2;                  ///< that make a cell crossed; one may be noise
  size_t max_rays = 3000000;         ///< more are thinned evenly; bounds the time
  double end_inset_m = 0.06;         ///< surfels near the ends mix in the adjoining planes
  float refine_cosine = 0.9F;        ///< 25 degrees between a point's normal and the plane's
  size_t min_refine_points = 200;    ///< fewer do not improve the fit
  double min_fixture_m = 0.02;       ///< before the plane; nearer is noise
  double max_fixture_m = 0.08;       ///< before the plane; no handle protrudes farther
  double fixture_inset_m = 0.03;     ///< the side of a neighbouring cupboard is not a fixture
  double max_reach_m = 2;            ///< no handle is higher
  double min_fixture_share = 0.1;    ///< of what was seen where one is: a thin bar covers a fifth of a column
  size_t min_fixture_points = 40;    ///< about one knob at the resolution of a scan
  double column_m = 0.05;            ///< of a plane's length
  double behind_m = 0.12;            ///< points farther behind a plane were seen past or through it
  double max_behind = 0.35;          ///< windows and doors show what is behind a part of a wall
  double max_passed_over = 0.3;      ///< of its length; furniture is lower than the room
  double min_seen_above = 0.3;       ///< of its length: enough to know what is above
  double max_pierced = 0.6;          ///< of its area; a wall may have large windows
  double at_ceiling_m = 0.12;        ///< shadows hide this much below the ceiling
  double below_ceiling_m = 0.25;     ///< a wall that ends lower is hidden or none
  double cupboard_side_m = 1.0;      ///< narrower planes below the ceiling are furniture sides
  double min_length_m = 0.3;         ///< narrower planes are window reveals …
  double min_pillar_m = 0.1;         ///< … but those that reach the top of the room: surfels mix in corners
  double narrow_m = 0.5;             ///< up to which the direction of a face is that of the room …
  double narrow_cosine = 0.966;      ///< … if it is within 15 degrees of it
  size_t min_tops = 3;               ///< long walls that show where a room ends above …
  double same_top_m = 0.03;          ///< … by tops within a surfel of each other
  double parallel_cosine = 0.9995;   ///< 1.8 degrees
  double same_plane_m = 0.025;       ///< between pieces of one wall: noise and drift
  double max_door_m = 1.3;           ///< gap that a door makes in a wall
  double max_window_depth_m = 0.5;   ///< from a wall's face to the pane
  double min_window_depth_m = 0.03;  ///< nearer is the wall itself
  double min_furniture_depth_m = 0.25;  ///< of tall furniture before a wall
  double max_furniture_depth_m = 0.8;   ///< of tall furniture before a wall
  double beside_m = 0.5;                ///< gap along the wall between furniture and the wall seen beside it
  double min_wall_beside_m = 0.8;       ///< a shorter wall may be the back of a niche
  double corner_m = 0.12;               ///< before a corner, where no surfel is of one wall alone
  double min_corner_sine = 0.5;         ///< between walls that make a corner
};
inline constexpr WallParameters kWalls;

/// Doorways and windows in walls.
struct OpeningParameters {
  double fine_m = 0.01;          ///< cells in which edges are found: a laser's spacing at 2 m
  double on_plane_m = 0.03;      ///< a ray that ends farther behind has passed: its end is on the reveal
  int fine_cells = 5;            ///< of a cell in which openings are sought
  double min_width_m = 0.35;     ///< narrower holes are gaps beside furniture
  double min_height_m = 0.35;    ///< a small window
  double pierced_side = 0.5;     ///< of the outer cells: fewer do not belong to the rectangle
  double pierced_inside = 0.9;   ///< of the cells that were seen
  double known_inside = 0.6;     ///< of the cells: the others were out of view
  double min_passage_m = 2.2;    ///< above the floor, to which rays pass: doors have a lintel below
  int edge_cells = 2;            ///< beside an opening, in which its wall must be seen
  double known_edge = 0.2;       ///< of them, as furniture hides parts of an edge
  double solid_edge = 0.6;       ///< of those that were seen
  double max_threshold_m = 0.5;  ///< above the floor, where a doorway may be in shadow
};
inline constexpr OpeningParameters kOpenings;

}  // namespace loci::mapping
