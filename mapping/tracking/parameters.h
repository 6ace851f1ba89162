#pragma once

#include <cstddef>
#include <cstdint>

#include "mapping/base/math/math.h"

namespace loci::mapping::tracking {

/// Images that frames are aligned with.
struct ImageParameters {
  int width = 320;               ///< of the finest level, about: half of a Kinect's, the noise is averaged
  int min_level_width = 64;      ///< a coarser level is not made
  float jump = 0.006F;           ///< 1/m; inverse depths of one surface differ by less …
  float relative_jump = 0.008F;  ///< … plus this part of the inverse depth, from pixel to pixel
  int smoothing_radius = 2;      ///< px; inverse depth is linear on planes, so its mean has no bias
  int normal_step = 3;           ///< px; half of the base line of normals on the finest level
  float intensity_offset = 20;   ///< log(1 + I / offset): a gain becomes a shift, dark noise is not blown up
  float intensity_scale = 64;    ///< about 170 values between black and white
  float saturated = 250;         ///< of 255; how much brighter it is than that is not known
};
inline constexpr ImageParameters kImages;

/// Dense alignment of a frame with keyframes.
struct AlignmentParameters {
  int max_steps[4] = {6, 5, 6, 6};                 ///< by level, finest first
  int stride[4] = {2, 2, 2, 1};                    ///< px between the model points of a level
  float gate_m[4] = {0.03F, 0.06F, 0.12F, 0.25F};  ///< residuals beyond have no weight
  float gate_per_z2 = 0.006F;                      ///< wider by this times z²: the noise there
  float same_side_cosine = 0.75F;                  ///< normals agree within 41 degrees
  double disparity_sigma = 0.0023;  ///< σ of depth = this · z²: a Kinect's 0.1 px with f 585 and 75 mm
  double floor_sigma = 0.006;       ///< m; what does not shrink with distance: distortion, quantisation
  float intensity_sigma = 12;       ///< on the logarithmic scale
  float intensity_gate = 40;
  float min_intensity_slope = 2.5F;  ///< per px; less is noise
  double normal_variance = 1e-3;     ///< of the model's normals: about two degrees
  double correlation = 10;           ///< neighbouring residuals repeat each other: so many count as one
  double stop_translation = 1e-4;    ///< m; a smaller step ends a level …
  double stop_rotation = 1e-4;       ///< rad
};
inline constexpr AlignmentParameters kAlignment;

/// Whether a pose is to be believed.
struct VerdictParameters {
  size_t min_compared = 500;         ///< model points seen in the frame
  double min_inliers = 0.65;         ///< of the compared ones
  double max_position_sigma = 0.01;  ///< m
  double max_rotation_sigma = 0.5 * kDegree;
  double max_intensity_error = 14;       ///< mean, on the logarithmic scale
  double max_noise = 0.0035;             ///< 1/m, of depth over its square: beyond, normals fail, too
  double max_speed = 3.0;                ///< m/s of a hand-held camera
  double max_turn_rate = 300 * kDegree;  ///< rad/s
};
inline constexpr VerdictParameters kVerdict;

/// How steadily a hand-held camera moves: decides where the images do not.
struct MotionParameters {
  double acceleration = 6;           ///< m/s²
  double angular_acceleration = 30;  ///< rad/s²
  double speed = 1;                  ///< m/s, where it is not known
  double turn_rate = 2;              ///< rad/s, likewise
};
inline constexpr MotionParameters kMotion;

/// Keyframes and the constraints between them.
struct KeyframeParameters {
  size_t references = 3;       ///< that a frame is aligned with at once
  double min_overlap = 0.3;    ///< of a keyframe's points in view
  double new_below = 0.70;     ///< overlap with the best keyframe
  double new_beyond_m = 0.30;  ///< from the best keyframe
  double new_beyond_rad = 20 * kDegree;
  uint8_t max_weight = 30;     ///< of fused depth, in frames
  size_t loop_candidates = 4;  ///< by appearance
  size_t loop_gap = 4;         ///< keyframes between the ends of a loop, at least
  double loop_overlap = 0.4;   ///< of keyframes that may close a loop by their poses
  size_t patience = 5;         ///< frames that are lost before tracking starts anew
  /// Of what comes from elsewhere than the last frame: a wrong loop is worse than none. Right ones have 0.97
  /// or more of simulated and 0.99 of real depth; wrong ones, as of two equal cabinets, up to 0.92.
  double min_loop_inliers = 0.95;
  /// Of the same, both directions together. Wrong ones had 0.055 to 0.16 where fronts of furniture repeat,
  /// right ones up to 0.03 in one direction: the margin is thin, and a lost loop costs less than a wrong one.
  double max_contradiction = 0.05;
};
inline constexpr KeyframeParameters kKeyframes;

/// Corners that are matched where dense alignment has no good start.
struct FeatureParameters {
  int count = 500;
  int levels = 4;
  int max_distance = 64;          ///< bits of 256
  int min_matches = 12;           ///< that agree on one motion
  double min_match_share = 0.25;  ///< of the matches
  int samples = 200;              ///< of three matches
  double gate_m = 0.02;           ///< plus gate_per_z2 · z²
  double gate_per_z2 = 0.01;
  int tables = 8;  ///< of the index of keyframes by appearance
  int table_bits = 16;
};
inline constexpr FeatureParameters kFeatures;

/// When a camera counts as standing still.
struct StillParameters {
  double max_shift = 0.01;  ///< m
  double max_turn = 0.6 * kDegree;
};
inline constexpr StillParameters kStill;

}  // namespace loci::mapping::tracking
