#pragma once

#include <cstddef>

namespace loci::mapping {

/// Connected pieces of upward surface.
struct LayerParameters {
  float gap_m = 0.03F;    ///< a wider gap in a column begins another layer
  float step_m = 0.015F;  ///< between neighbouring columns: depth camera noise
  int reach_columns = 2;  ///< objects and noise leave holes this wide
  size_t min_points = 2;  ///< single points are mixed returns
};
inline constexpr LayerParameters kLayers;

/// The search for horizontal supports.
struct SupportParameters {
  double min_height_m = 0.2;   ///< above the floor; plinths and steps are lower
  double cell_m = 0.02;        ///< a depth camera's point distance at 4 m
  double reach_m = 0.4;        ///< objects part pieces of one surface by this much
  double lookout_m = 0.9;      ///< around the pieces: a slab may continue behind an object
  double margin_m = 0.1;       ///< around the pieces, of the raster
  double through_m = 0.05;     ///< a ray that ends this far below passed through
  double rim_depth_m = 0.03;   ///< thickness of usual slabs: their vertical edge
  double below_m = 0.15;       ///< body below a slab, with which the edge is compared
  double max_shadow_m = 1.0;   ///< from an object to the end of what it hides
  double max_tilt = 0.03;      ///< slope; drift makes less
  double touch_m = 0.06;       ///< between rectangles of one support: two raster cells and noise
  double tilt_prior = 60;      ///< weighs as so many cells 1 m away that are level
  size_t min_piece_cells = 6;  ///< smaller pieces are noise
  double tall_m = 0.6;         ///< objects on a counter are lower
  double tall_cell_m = 0.05;   ///< of the columns in which tall objects are sought
  unsigned tall_slices = 5;    ///< all of them must be occupied
  int max_rectangles = 8;      ///< of one plane; bounds the time
  double min_fill = 0.3;       ///< of a rectangle that was seen as surface
  double row_m = 0.04;         ///< rectangles of one row agree in front and back within this
  double same_level_m = 0.01;  ///< between two pieces of one slab
  double same_yaw = 0.01;      ///< radians, between two pieces of one slab
};
inline constexpr SupportParameters kSupports;

/// The direction of a support's edges, over which the walls' wins within the noise.
struct DirectionParameters {
  double min_area_m2 = 0.3;     ///< less surface does not determine a yaw of its own
  double coarse_cell_m = 0.04;  ///< of the raster in which a first yaw is sought
  double gain = 1.05;           ///< of another yaw's score, times the one at the room's
  double step = 0.0524;         ///< radians, of that search: within the window on a side of 2 m
  double window_m = 0.1;        ///< how far off the coarse raster's edge may be, turned by a step
  double min_noise_m = 0.002;   ///< of an edge's position in a strip
  double min_straight = 0.4;    ///< of the strips that lie on one line: round tops have no edges
  int rounds = 8;               ///< of a fit
  double same = 2e-4;           ///< radians, by which a fit that has converged turns
  double edge_noise_m = 0.015;  ///< between the ends of an edge: range noise and registration at both
};
inline constexpr DirectionParameters kDirections;

/// Scores per cell: evidence for and against a rectangle; tuned on the sample kitchens.
struct RasterParameters {
  float support = 1.0F;           ///< surface was seen
  float maybe = -0.01F;           ///< points at the height without a clear normal
  float pierced = -1.5F;          ///< rays passed through
  float sunk = -0.3F;             ///< a counter may have a sink
  float hidden = -0.03F;          ///< an object stands above: the surface may continue below it
  float near = -0.12F;            ///< unknown, but close to surface
  float unknown = -0.35F;         ///< unknown and far from surface
  float consumed = -50.0F;        ///< another support has it: never overlap
  double near_m = 0.15;           ///< objects hide surface up to this far from what was seen
  double min_pierced = 0.05;      ///< of a piece in which rays passed, to be no sink: a basin has none
  double sunk_m = 0.3;            ///< a ray that ends less below a plane has sunk in, not passed through
  double closed_gap_m = 0.12;     ///< of the contour: holes that objects leave
  double contour_margin_m = 0.1;  ///< around the rectangle, in which the contour is traced
  int contour_scale = 3;          ///< the contour runs through cells of a finer image
};
inline constexpr RasterParameters kRaster;

/// Exact position of a support's edges, and its height.
struct EdgeParameters {
  double window_m = 0.06;        ///< how far off the raster's edge may be
  double rim_bin_m = 0.005;      ///< step of the search for the rim's peak
  double rim_half_m = 0.012;     ///< half width of the peak: range noise and registration
  double min_rim_per_m = 60;     ///< points that make a peak
  double rim_contrast = 2.5;     ///< times as dense as the rest of the window
  double split_step_m = 0.0025;  ///< step of the search for the separating line
  double min_split_per_m = 40;   ///< samples on both sides that determine the line
  double small_growth_m = 0.01;  ///< needs no evidence: within the raster's cell
  double growth_density = 0.4;   ///< of the density inside
  double strip_m = 0.02;         ///< along the edge; a raster cell
  double inside_m = 0.06;        ///< how far inside the raster's edge the true one may be
  double outside_m = 0.05;       ///< and how far outside
  double snap_m = 0.12;          ///< an unseen edge this near to a wall ends at the wall
  size_t min_scan_points = 30;   ///< of a scan that counts for the height
  size_t min_strips = 6;         ///< of a scan that counts for an edge
  double bin_m = 0.005;          ///< step by which an edge grows
  double inner_m = 0.06;         ///< inside the edge, with which the density is compared
  double dense = 0.5;            ///< of that density, as long as the surface continues
  double corner_inset_m = 0.03;  ///< corners mix two edges
  double below_cell_m = 0.05;    ///< cells in which rays below the support are counted
};
inline constexpr EdgeParameters kEdges;

/// Circles and polygons against rectangles; tuned on the sample kitchens.
struct OutlineParameters {
  double same_end_m = 0.06;            ///< rectangles that end this near to each other end together
  double min_gain = 0.04;              ///< of the area, over rectangles
  double corner_cost = 0.01;           ///< of the area, for each corner beyond four
  double circle_gain = 0.03;           ///< of the area, that a polygon must be better than a circle
  int circle_corners = 48;             ///< of the polygon of a circle
  double polygon_tolerance_m = 0.025;  ///< about a raster cell
  double max_circle_rms_m = 0.025;     ///< about a raster cell
};
inline constexpr OutlineParameters kOutlines;

/// Slabs that continue behind an object on them.
struct OcclusionParameters {
  double row_m = 0.02;         ///< along the gap and across: a raster cell
  double max_gap_m = 0.8;      ///< that one object hides
  double edge_reach_m = 0.05;  ///< from a slab's edge to the points that belong to it
  double face_reach_m = 0.12;  ///< from a slab's edge to the front below it: overhang
  double max_free = 0.05;      ///< of a row, through which rays passed
  double min_surface = 0.4;    ///< of a row, to be support
  double min_hidden = 0.8;     ///< of the rows between, that show an object and the slab's edge
  double min_beyond_m = 0.04;  ///< surface on the other side: two rows
  double face_depth_m = 0.4;   ///< minimum extent of a front below the slab
  double in_line_m = 0.015;    ///< between a slab's edge on one row and on the others: noise
  double step_m = 0.008;       ///< between a slab's edge and what is below or above it
  size_t min_points = 3;       ///< that determine a median
};
inline constexpr OcclusionParameters kOcclusion;

/// Counters of which only the front was seen.
struct HiddenCounterParameters {
  double column_m = 0.05;        ///< of a face, whose top is measured column by column
  double level_m = 0.03;         ///< by which the top varies at most
  double min_level = 0.5;        ///< of the columns
  double max_depth_m = 0.9;      ///< from a face to the wall behind it
  double min_depth_m = 0.25;     ///< narrower is no counter
  double min_seen_m2 = 0.02;     ///< of upward surface that must confirm the height
  double max_pierced = 0.1;      ///< of the top, through which rays passed
  double same_height_m = 0.045;  ///< as a support that was found before
  double end_gap_m = 0.12;       ///< corners are seen less well: a top that ends so near ends there
  double max_overhang_m = 0.08;  ///< of a slab before its front
  double height_bin_m = 0.01;    ///< of the height histogram
  double height_reach_m = 0.03;  ///< about the face's top
  int coverage_steps = 20;       ///< per side, to compare two supports
  double corner_gap_m = 0.2;     ///< between two counters in a corner
};
inline constexpr HiddenCounterParameters kHiddenCounters;

/// Legs and pedestals of tables.
struct LegParameters {
  double cell_m = 0.02;         ///< a neighbourhood of 3 × 3 holds the noise of a side
  double level_m = 0.05;        ///< step in height in which a leg must show
  double above_floor_m = 0.05;  ///< lower are the foot of a pedestal, and the floor itself
  double below_top_m = 0.06;    ///< higher are the slab and its frame
  int min_levels = 6;           ///< lower tables are seats
  double seen_levels = 0.6;     ///< of all levels, and of the upper third: chairs hide the others
  double central_m = 0.1;       ///< from the middle of the top, where no chair stands: a pedestal …
  double seen_central = 0.3;    ///< … which the top hides from above
  double min_points = 0.1;      ///< of the leg with most points
  double max_side_m = 0.2;      ///< wider posts are panels or furniture below the table
  double min_side_m = 0.02;     ///< of a leg of which one side was seen
  double outliers = 0.05;       ///< of the points at either end
};
inline constexpr LegParameters kLegs;

/// Counter, table, shelf, island: sizes of usual kitchen furniture.
struct ClassParameters {
  double near_wall_m = 0.25;      ///< nearer than this a support stands at the wall
  double min_open_below = 0.05;   ///< of the footprint: free space was seen below
  double shelf_depth_m = 0.33;    ///< a narrower board at a wall is a shelf
  double min_shelf_m = 0.5;       ///< shorter boards above a counter are objects on it
  double table_top_m = 0.80;      ///< tables are lower, counters higher
  double max_counter_m = 1.05;    ///< a counter is not higher
  double min_counter_m = 0.65;    ///< lower boards over cabinets are shelves
  double max_bar_m = 1.2;         ///< of high tables
  double leg_openness = 0.4;      ///< of the footprint, seen from below: only legs leave so much free
  double min_table_m = 0.6;       ///< smaller ones are stools
  double min_seat_m = 0.36;       ///< height of a seat
  double max_seat_m = 0.54;       ///< height of a seat
  double max_seat_side_m = 0.62;  ///< largest side of a seat
  double on_top_m = 0.45;         ///< a surface this little above another one stands on it
  int overlap_steps = 12;         ///< per side, to compare two supports
  double edge_reach_m = 0.06;     ///< of a larger surface, from which a drawer juts out
  double small_m2 = 0.12;         ///< free-standing surfaces that are smaller are stools and boxes
  double walk_m = 0.5;            ///< space in which a person walks round an island
};
inline constexpr ClassParameters kClasses;

}  // namespace loci::mapping
