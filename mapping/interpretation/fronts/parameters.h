#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace loci::mapping {

/// Range noise of a point on a furniture face after averaging and registration (Kinect at 1.5 m, laser
/// scanner), metres.
inline constexpr double kRangeSigma = 0.005;

/// Furniture faces and the rays that met them.
struct FaceParameters {
  double piece_m = 0.03;                   ///< cells whose points are averaged before planes are sought
  int angle_bins = 240;                    ///< of the Hough votes: 1.5 degrees each
  int angle_spread_bins = 3;               ///< a piece's normal is known within 4.5 degrees
  double offset_bin_m = 0.015;             ///< of the Hough votes: layers 3 cm apart are separate
  double min_facing_cosine = 0.95;         ///< 18 degrees between a piece's normal and its plane's
  double explained_m = 0.022;              ///< pieces this near to a plane belong to it
  double min_area_m2 = 0.04;               ///< a small drawer front
  double max_gap_m = 1.0;                  ///< a mirror-like front may leave such a hole
  double same_face_m = 0.035;              ///< panels and carcass of one face lie this near
  double parallel_cosine = 0.99;           ///< 8 degrees
  int fixture_gap_cells = 3;               ///< a plane continues within this beside a fixture
  size_t max_faces = 80;                   ///< more than any room has; bounds the time
  double min_height_m = 0.03;              ///< above the floor: skirting and noise
  size_t min_piece_points = 2;             ///< single points have no reliable normal
  double align_reach_m = 6 * kRangeSigma;  ///< points used to compare scans; more is relief
  double floor_gap_m = 6 * kRangeSigma;    ///< points below belong to the floor
  double min_scan_points = 100;            ///< of a scan that saw the face
  double min_slope_m2 = 0.04;              ///< variance along the face below which no slope is estimated
  double max_slope = 0.01;                 ///< radians by which registration is off at most
  double agree_cell_m = 0.03;              ///< cells in which scans are compared
  size_t min_agree_cells = 30;             ///< that two scans share
  int agree_rounds = 8;                    ///< alternating offsets and means settle
  float min_cosine = 0.15F;                ///< of incidence; intensity divided by less is noise
  double cell_m = 0.004;                   ///< of all rasters over faces: about the width of a seam
  double margin_m = 0.12;                  ///< around a face
  double relief_m = 0.035;                 ///< nearer points belong to the face
  double fixture_reach_m = 0.11;           ///< handles do not protrude farther
  double before_m = 0.30;                  ///< rays that end farther before a face do not concern it
  double ground_rank = 0.7;                ///< of the depths around: bars cover less than the rest
  double ground_rank_sigmas = 0.524;       ///< by which that rank of a normal distribution exceeds its mean
  size_t ground_min_points = 30;           ///< in a neighbourhood
  double max_sigma_m = 0.012;              ///< more is relief, not noise
  int ground_cells = 10;                   ///< of the raster per side of a patch: 4 cm, wider than bars
};
inline constexpr FaceParameters kFaces;

/// Handles and knobs: sizes of usual hardware.
struct FixtureParameters {
  double line_tolerance_m = 0.012;  ///< registration of the scans and half a bar
  int thin_cells = 8;               ///< patches of one bar are no thicker
  int join_gap_cells = 11;          ///< a bar may be hidden or missed over this length
  int join_bars_cells = 14;         ///< where one of them is long: a bar
  int join_offset_cells = 2;        ///< between the middle lines of patches of one bar
  double gap_step_m = 0.01;         ///< of a bar's length, in which rays through and on it are counted
  double min_gap_m = 0.03;          ///< between bars of neighbouring fronts, each 1.5 cm from the edge
  size_t min_gap_rays = 5;          ///< through the gap, for each that met something there
  double min_grip_m = 0.008;        ///< free behind a bar: a slim fingertip needs 10 mm, less 2 mm of noise
  double min_long_grip_m = 0.014;   ///< of a long bar: a hand needs 25 mm, mixed returns take 1 cm off
  double min_protrusion_m = 3 * kRangeSigma;  ///< nearer to the face is noise
  double max_bar_m = 1.3;                     ///< of a fridge
  double min_bar_m = 0.045;                   ///< shorter is a knob
  double max_bar_width_m = 0.045;             ///< a hand does not close around more
  double max_knob_m = 0.065;                  ///< a hand does not close around more
  double min_knob_m = 0.008;                  ///< two raster cells
  double bar_elongation = 2.2;                ///< length over width that makes a bar
  double max_tilt = 0.35;                     ///< radians; handles are level or upright
  /// Of a cell's points before the face, pass by pass: connected objects separate later.
  std::array<float, 3> min_shares = {0.3F, 0.45F, 0.65F};
  double min_shown_at_ends = 0.25;     ///< of the cells beyond a bar's ends that are face
  double long_bar_m = 0.3;             ///< may be as long as its front …
  double min_shown_beside_long = 0.7;  ///< … if so much beside it is face
  double max_rib_spacing_m = 0.22;     ///< between upright bars of one radiator: no fronts are so narrow …
  size_t min_ribs = 3;                 ///< … in a row of so many
  double rib_overlap = 0.6;            ///< of the shorter one's height
  double min_hit_depth = 0.6;          ///< of its distance from the face; nearer, a ray passed by it
  double core = 0.38;                  ///< of length and width to each side that rays certainly meet
  size_t min_points = 10;              ///< of a line fit
  size_t many_points = 40;             ///< so many are not all mixed returns
  double min_cells_beside = 6;         ///< that rays met, to judge the surroundings
  size_t min_strip_cells = 3;          ///< of face between a bar and that of the next door
  double surroundings_m = 0.035;       ///< beside a fixture, in which its front shows
  double min_shown = 0.4;              ///< of the cells beside it that are face
  float min_density = 0.07F;           ///< points per cell after smoothing: one within 6 mm
  double half_round = 0.785;     ///< mean distance of a cylinder's visible half from its axis over its radius
  double extend_reach_m = 0.12;  ///< beyond each end of a bar
  double extend_step_m = 0.022;  ///< between consecutive points of a bar
  double extend_depth = 0.6;     ///< of the bar's distance from the face
  double ghost_reach_m = 0.1;    ///< from a bar to a ghost of mixed returns
  double same_bar_m = 0.008;     ///< between pieces of one bar: two raster cells
  double ghost_points = 0.35;    ///< of the bar's points, that a ghost has at most
  double unite_offset_m = 0.015;  ///< between the middle lines of pieces of one bar
};
inline constexpr FixtureParameters kFixtures;

/// Seams and edges in a face; tuned on the sample kitchens.
struct SeamParameters {
  int flank_cells = 6;      ///< on each side, with which a line is compared
  int flank_gap_cells = 1;  ///< between a line and its flanks
  int window_chunks = 5;    ///< a line without evidence over this length is interrupted
  float min_cosine = 0.3F;  ///< of incidence; flatter rays cross the face at an uncertain place
  double max_z = 4;         ///< influence of one chunk
  double shown_z = 1;       ///< a chunk with more shows the line
  float min_weight = 1.5F;  ///< rays in a line's part of a chunk
  /// By channel (metres, share, intensity, colours): differences that are not evidence, by shading and
  /// registration.
  std::array<double, 6> trivial = {0.001, 0.02, 0.008, 0.006, 0.006, 0.006};
  /// By channel: minimum noise of a ray.
  std::array<double, 6> min_sd = {0.002, 0.05, 0.01, 0.008, 0.008, 0.008};
  double beam_m = 0.018;                    ///< radius of a beam that may touch a fixture
  double end_margin_m = 0.01;               ///< at both ends of a line that is not used
  int core_cells = 3;                       ///< in which the line is
  double blur_m = 0.008;                    ///< by which beam and registration widen a thin line
  int chunk_cells = 10;                     ///< along a line: 4 cm
  std::array<int, 3> half_widths{0, 1, 3};  ///< cells; of the seams that are tested
  int profile_cells = 8;                    ///< across a line, to each side
};
inline constexpr SeamParameters kSeams;

/// How a face is cut into fronts; tuned on the sample kitchens.
struct LayoutParameters {
  double min_z = 6;                 ///< of a cut
  double min_share = 0.6;           ///< of a cut's length that shows it
  double min_side_m = 0.028;        ///< narrower parts are not cut off
  double min_weakest = 0.3;         ///< of a line's mean score, along all its length
  double min_front_m = 0.08;        ///< narrower parts are frames
  double min_cut_face = 0.08;       ///< of the known cells of a row or column, while the face is cut
  double min_known = 0.1;           ///< of a row or column that rays met
  double min_gap_m = 0.015;         ///< wider strips without face separate parts
  int outline_cells = 20;           ///< beside a step of the outline: 8 cm, the narrowest front
  double outline_clear = 0.8;       ///< of these that show the same
  double min_outline_step_m = 0.3;  ///< a niche or a notch is lower
  double max_hidden_m = 0.1;        ///< wider strips that no ray met separate parts, too
  double min_face = 0.4;            ///< of the known cells of a row or column of a front
  int max_depth = 60;               ///< of the recursion
  double same_line_m = 0.03;        ///< by which the exact position of a line differs
  double border_confidence = 0.6;   ///< of an edge where the face ends
  double regular_confidence = 0.3;  ///< of an edge that was not resolved
  double min_seen = 0.5;            ///< of a front that is face
  double min_seen_fixed = 0.25;     ///< of one with a fixture, that rays met and is face
  double min_bare_z = 8;            ///< of the seam of a front without fixture …
  double clear_edge = 0.9;          ///< … or so much of what a short one can show at most
  double min_bare_m2 = 0.02;        ///< of a front without fixture
  double flush_m = 0.005;          ///< between panels of one plane: they are 16 to 20 mm thick, 1 mm of noise
  double fixture_gap_m = 0.004;    ///< one raster cell between a cut and a fixture
  double max_settle_m = 0.012;     ///< three raster cells
  double neighbour_gap_m = 0.012;  ///< three raster cells between neighbouring fronts
  double plinth_level_m = 0.02;    ///< between the lower edges of fronts over one plinth: five cells
  double shared_edge = 0.5;        ///< of the shorter edge of neighbouring fronts
};
inline constexpr LayoutParameters kLayout;

/// Fronts whose seams were not resolved; tuned on the sample kitchens.
struct DivisionParameters {
  double confidence = 0.7;      ///< of the division: there may be other fronts
  double step_m = 0.01;         ///< of possible edges
  double style_step_m = 0.005;  ///< of the common distance between fixture and edge
  double frame_cost = 2.5;      ///< of a frame beside the outermost fronts
  double min_margin_m = 0.01;   ///< between a fixture and the edge of its front
  double hand_m = 0.06;         ///< space that an upright handle or knob needs
  double style_sd_m = 0.012;    ///< of the distance between fixture and edge in one column
  double max_style_cost = 4;    ///< of a fixture that is mounted otherwise
};
inline constexpr DivisionParameters kDivision;

/// Which faces and fronts are accepted.
struct FrontParameters {
  uint64_t seed = 7;              ///< of the sample consensus
  double same_wall_m = 0.08;      ///< between a face and the wall it is a piece of
  double in_wall_m = 0.01;        ///< a front that faces elsewhere is so far behind a wall's face …
  double behind_wall_m = 0.3;     ///< … but no farther: there may be another room
  double max_width_m = 1.4;       ///< no front is wider
  double max_area_m2 = 2.2;       ///< none is larger
  double min_side_m = 0.07;       ///< a narrow drawer front
  double min_upright_m = 0.12;    ///< of an upright one: pull-outs are 15 cm wide, ribs of radiators less
  double min_bare_side_m = 0.12;  ///< narrower ones without fixture are filler strips …
  double niche_edge_m = 0.03;     ///< from the edge of a front to a board that stands out there …
  double niche_step_m = 0.03;     ///< … over so many steps of its depth …
  static constexpr size_t niche_steps = 4;
  size_t niche_points = 5;               ///< … with so many points in each
  double min_plinth_m = 0.01;            ///< … but for drawers that the plinth recedes below by so much
  double max_sigma_m = 3 * kRangeSigma;  ///< more are corners and clutter, in which handles disappear
  double min_fixture_confidence = 0.4;   ///< on furniture
  double min_wall_fixture_confidence = 0.75;  ///< on a possible wall
  size_t min_wall_fronts = 2;                 ///< on a possible wall
  int min_wall_edges = 3;                     ///< resolved, on a possible wall
  double same_front_m = 0.08;                 ///< between the planes of one front that was found twice …
  double same_front_cover = 0.5;              ///< … and of the smaller one that the other covers
  double max_corner_cosine = 0.3;             ///< between the normals of fronts at a corner …
  double max_corner_m = 0.06;                 ///< … and from one to the edge of the other
  double depth_inset_m = -0.01;               ///< edges and seams are left out
  double max_slope = 0.1;                     ///< against its face; more spans a corner of other planes
  size_t min_rays = 50;                       ///< of a front and of the rest of its face
  double dark = 0.4;                          ///< an oven's pane returns less of the others' intensity
};
inline constexpr FrontParameters kFronts;

}  // namespace loci::mapping
