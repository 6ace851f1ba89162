#pragma once

#include <array>
#include <cstddef>

#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {

/// Orthophotos of furniture faces.
struct PhotoParameters {
  double pixel_m = 0.003;        ///< a colour pixel of a 640 × 480 camera at 1.6 m
  double min_area_m2 = 0.12;     ///< of a face: smaller than two drawers is clutter
  double same_face_m = 0.06;     ///< between planes of one face that depth errors divide …
  double same_face_cover = 0.6;  ///< … and of the smaller one that the larger one covers
  double margin_m = 0.08;        ///< around a face
  /// Layers: the face as all frames alike show it, with which the others are compared, and bars and knobs.
  std::array<double, 6> layers_m = {0, 0.015, 0.025, 0.035, 0.045, 0.055};
  double max_range_m = 4;                    ///< of a frame: a pixel is 7 mm there
  double min_cosine = 0.25;                  ///< of incidence: flatter views stretch pixels fourfold
  double probe_m = 0.10;                     ///< between the places by which frames are chosen
  size_t frames_per_probe = 8;               ///< the best of each place
  size_t max_frames = 48;                    ///< of a face: a median gains little beyond, memory grows
  double before_m = kFaces.fixture_reach_m;  ///< nearer surfaces hide the face
  double behind_m = kFaces.relief_m;         ///< farther ones are seen beside it
  double unmeasured_weight = 0.3;            ///< of colours without depth: something may hide the face
  double fit_reach_m = 6 * kRangeSigma;      ///< from the plane, of the depths that correct a frame
  double max_drift_m = 0.05;                 ///< of a frame along the normal
  double max_tilt = 0.03;                    ///< of a frame: 1.7 degrees
  double min_spread_m2 = 0.01;               ///< variance of depths along an axis that shows a tilt
  size_t min_fit_points = 200;               ///< of a frame's plane
  int fit_step_px = 4;                       ///< between them
  int align_step_px = 2;                     ///< pixels of the orthophoto per pixel of an alignment
  double max_shift_m = 0.03;                 ///< of a frame in the plane
  double min_overlap_m2 = 0.08;              ///< with the other frames, for an alignment
  double min_correlation = 0.3;              ///< of the gradients, for an alignment
  double roll_step = 0.00175;                ///< radians, a tenth of a degree
  int roll_steps = 30;                       ///< to each side
  double min_roll_gain = 1.02;               ///< of the straightness, to turn an image at all
  int same_color = 25;                       ///< between frames that agree, of 255 per channel
  int align_rounds = 2;                      ///< alternating shifts and medians settle
};
inline constexpr PhotoParameters kPhoto;

/// Upright steps of faces, as single frames show them.
struct StepParameters {
  double column_m = 0.05;     ///< of the profile along a face
  size_t min_points = 20;     ///< of a column in a frame
  size_t reach = 4;           ///< columns on each side that are compared: wider than handles and frames
  size_t min_frames = 3;      ///< that show both sides
  double min_step_m = 0.015;  ///< more than a tilt of kPhoto.max_tilt makes over the reach, and than noise
};
inline constexpr StepParameters kSteps;

/// Bars in orthophotos.
struct BarParameters {
  std::array<int, 3> widths_px = {2, 4, 6};  ///< 6 to 18 mm
  int smooth_px = 7;                         ///< along a bar: a third of the shortest
  double min_noise = 0.004;                  ///< of contrasts: one grey level
  double min_score = 4;                      ///< contrast over its noise
  double max_gap_m = 0.02;                   ///< in a bar
  double min_length_m = 0.08;                ///< the shortest usual bars have 96 mm between their posts
  int max_wander_px = 2;                     ///< of a bar from its middle line
  double min_filled = 0.7;                   ///< of its length that is stronger than its surroundings
  double face_relief_m = kFaces.relief_m;    ///< nearer to the plane is face
  double surroundings_m = 0.025;             ///< beside a bar, in which the face shows
  double min_beside = 0.6;                   ///< of these pixels
  double beyond_m = 0.06;                    ///< beyond each end, where seams and edges continue
  double max_continuation = 0.4;             ///< of its contrast there, over that of the bar
  double max_end_change = 0.7;       ///< of the face's colour beyond an end, over the contrast of the bar
  double max_side_change = 1;        ///< between the colours on both sides, over the contrast of the bar
  double max_recess_sigmas = 2;      ///< by which a bar lies behind its flanks: seams do
  double min_relief_m = 0.01;        ///< of a bar that only the relief shows: half of it is measured
  double usual_protrusion_m = 0.03;  ///< of bars that depth does not resolve
  double max_protrusion_m = 0.06;    ///< of usual hardware
  double half_score = 8;             ///< twice the minimum: confidence 0.5
  double same_bar_m = 0.03;          ///< between two findings of one bar and its shadow
  double smear_sigmas = 2;           ///< of the directions of the frames, for bars that no layer shows
  double min_standing_score = 15;    ///< of a bar that a layer shows
  /// Of the frames on what a layer shows there, two thirds: a half agrees with the median of any two surfaces
  /// that cover each other.
  double min_agreement = 0.667;
  double layer_sd_m = 0.005;    ///< of the depth that a layer tells: half of their distance
  double min_layer_gain = 1.1;  ///< of a standing bar's score over that of the face at its place
};
inline constexpr BarParameters kBars;

/// What single frames show of bars and knobs in a layer.
struct PatchParameters {
  double min_seen = 0.6;      ///< of the places of a patch
  double min_contrast = 0.4;  ///< of its difference in the layer: frames are blurred and differ in exposure
  int reach_px = 2;           ///< from its place: layers are 1 cm apart
  /// Of the frames that see a patch: blur hides it in some, but what the median made up is in hardly any.
  double min_frames = 0.333;
};
inline constexpr PatchParameters kPatches;

/// Knobs in the layers before orthophotos.
struct KnobParameters {
  std::array<int, 2> radii_px = {4, 6};  ///< 24 and 36 mm across
  double ring = 1.9;               ///< of the places around a knob where the face shows, over its radius
  double min_score = 15;           ///< contrast over its noise, in the weakest direction
  double min_noise = 0.004;        ///< of contrasts: one grey level
  double min_layer_gain = 1.3;     ///< of its score over that of the face at its place
  double min_relief_m = 0.015;     ///< of a knob that no layer shows clearer
  double max_protrusion_m = 0.05;  ///< of a knob: deeper layers are not looked at
  double min_beside = 0.93;        ///< of the pixels around that are face
  double min_apart_m = 0.03;       ///< between knobs, and to bars
  double half_score = 15;          ///< confidence 0.5
};
inline constexpr KnobParameters kKnobs;

/// Seams and edges in orthophotos.
struct LineParameters {
  int chunk_px = 13;        ///< along a line: 4 cm
  int core_px = 3;          ///< of a seam, blurred by the camera
  int flank_px = 5;         ///< on each side, with which it is compared
  double min_sd = 0.004;    ///< one grey level
  float max_z = 6;          ///< influence of one chunk
  float shown_z = 1;        ///< a chunk with more shows the line
  double min_known = 0.6;   ///< of the chunks
  double min_z = 6;         ///< of a cut
  double min_share = 0.75;  ///< of a cut's chunks that show it
};
inline constexpr LineParameters kLines;

/// Fronts in orthophotos. Values are log likelihoods.
struct PhotoFrontParameters {
  double min_side_m = 0.08;    ///< of a front
  double min_strip_m = 0.05;   ///< between cuts: edges are blurred
  double min_face = 0.5;       ///< of the known pixels of a row or column of a front
  double min_known = 0.3;      ///< of the pixels of a row or column of a front
  double hidden_m = 0.02;      ///< around bars: their shadows
  double hidden_sigmas = 2;    ///< of the relief of such bars
  double bar_margin_m = 0.01;  ///< between a bar and the edge of its front
  double unsure_shift =
      0.3;  ///< of a bar's displacement by a view from the side: its protrusion is not exact
  double max_width_m = kFronts.max_width_m;
  double max_area_m2 = kFronts.max_area_m2;
  double front_value = 2;          ///< of a front with a bar where bars are, against none
  double extra_bar = 2;            ///< cost of a further bar in a front
  double bare_cost = 1.5;          ///< of a part without a bar: fronts have one where others have
  double bare_side_m = 0.2;        ///< of such a part: larger than plinths and slabs
  double line_cost = 0.25;         ///< of a line across a front, per standard score
  double max_line_z = 12;          ///< more makes a line no more certain: shadows are strong, too
  double same_fixture_m = 0.05;    ///< between two findings of one handle
  int min_resolved = 2;            ///< edges of a front that are lines or ends of the face
  int min_bare_resolved = 4;       ///< of a front without a bar, beside one that has one
  double min_bare_m = 0.12;        ///< narrower ones are filler strips
  double neighbour_m = 0.02;       ///< between neighbouring fronts
  double min_shared = 0.6;         ///< of the shorter edge of such neighbours
  double outline_m = 0.04;         ///< beside an end of the face …
  double outline_open = 0.3;       ///< … in which so much is known to be farther or nearer
  double min_lone_area_m2 = 0.35;  ///< of a face with a single front: backs of chairs, boxes
  double min_outline_step_m = kLayout.min_outline_step_m;  ///< of the face's extent, where it is cut
  double outline_window_m = 0.06;                          ///< on each side of such a step
  double outline_share = 0.75;  ///< of the window that is face on one side, but not on the other
  double min_between_m = 0.05;  ///< between bars of different fronts
  double weak_z = 2.5;          ///< of a line between two bars
  double regular_cost = 1;      ///< of a cut that no line shows; less for weak lines
  int max_depth = 40;           ///< of the recursion
};
inline constexpr PhotoFrontParameters kPhotoFronts;

}  // namespace loci::mapping
