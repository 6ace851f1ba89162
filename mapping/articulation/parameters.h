#pragma once

#include <cstddef>

#include "mapping/base/math/math.h"

namespace loci::mapping {

/// The face of a front before and after it moved.
struct FaceMotionParameters {
  int samples = 400;              ///< of the sample consensus
  double inlier_m = 0.02;         ///< of a plane: a depth camera's noise at 2 m
  size_t min_plane_points = 30;   ///< fewer do not determine a plane
  double hinge_depth_m = 0.01;    ///< behind the face: the middle of a panel of 2 cm
  double parallel_deg = 4;        ///< faces that differ by less did not turn
  double square_deg = 8;          ///< of an open face's normal to its hinge
  double closed_m = 0.04;         ///< from the known face, of points that may be on the closed one …
  double closed_inlier_m = 0.03;  ///< … and of those that it is fitted to
  double before_m = 0.1;          ///< behind a front, where its closed face may be seen
  double beside_m = 0.15;         ///< around what a front can reach
  double min_probability = 1e-4;  ///< of a type: neither shape nor hand exclude it
  double on_face_m = 0.025;       ///< from the plane of the moved face
  size_t min_points = 40;         ///< of a moved part
  int rounds = 3;                 ///< a face and the points that belong to it settle
  double cell_m = 0.03;           ///< of the raster over a front
  double fit_cell_m = 0.05;       ///< of the raster that tells whether scans fit a map
  double min_fit = 0.3;           ///< of a front's raster, to be there or to be looked through
  double inner = 0.45;            ///< of a front's extent, from its middle: edges are seen at a slant …
  double edge_m = 0.02;           ///< … and may lie so far inside: beyond is the top of a counter
  double fixture_gap_m = 0.015;   ///< beams still touch the fixture
  double normal_sd = 0.01;        ///< radians, of a front's normal in the map
  double near_face_m = 0.05;      ///< points that may be the closed face …
  double still_m = 0.01;          ///< … are it when their mean is so near: carcasses lie deeper
  double min_coverage = 0.35;     ///< of the front's rectangle by the moved face
  size_t min_poses = 5;           ///< of a hand's path that can separate line and arc
  double independent_cells = 4;   ///< errors of neighbouring cells are correlated: coverage counts as so many
  double min_support = 0.02;      ///< of a type that was not seen
  double view_reach_m = 8;        ///< origins farther away see the front too coarsely
};
inline constexpr FaceMotionParameters kFaceMotion;

/// The rectangle of a front by the outline of what moved.
struct OutlineParameters {
  double beyond_m = 0.3;         ///< around the known rectangle, which may be too small
  double cell_m = 0.01;          ///< of the histogram whose ends are edges
  double usual_rank = 0.6;       ///< of the cells by their points: those within the front
  double before_hinge_m = 0.02;  ///< an edge that hardly moved is at the hinge: it ends so far before it …
  double behind_hinge_m = 0.12;  ///< … or the face so far within it
  double min_inward_m = 0.015;   ///< less than a measured edge is off
  double min_seen_past = 0.5;    ///< of the strip beyond an edge that moved inwards
  double max_hinge = 1.5;        ///< distance of a hinge from the centre, in extents of the front
};
inline constexpr OutlineParameters kOutline;

/// The joint that explains faces and hand.
struct JointFitParameters {
  double axis_sd = 3 * kDegree;          ///< radians, of real joints about the axis that their shape suggests
  double hinge_depth_sd_m = 0.015;       ///< concealed hinges lie deeper than the panel's middle
  double face_tilt_sd = 0.15 * kDegree;  ///< radians, systematic: calibration and registration
  double face_offset_sd_m = 0.002;       ///< systematic: calibration and registration
  double robust_sigmas = 3;              ///< a pose that is farther off counts less
};
inline constexpr JointFitParameters kJointFit;

/// Joints and recordings of tracks, as known before a track is seen.
struct TrackParameters {
  double unknown_share = 0.02;        ///< of tracks are made by something else
  double radius_m = 0.45;             ///< median, of a handle about its hinge; log-normal
  double radius_log_sd = 0.7;         ///< of its logarithm
  double travel_m = 0.3;              ///< median, along the path; log-normal
  double travel_log_sd = 1.2;         ///< of its logarithm
  double wander_m = 0.001;            ///< rms by which a static object seems to move
  double bend = 0.0015;               ///< rms by which a straight path bends at least, per length
  double slack_m = 0.002;             ///< by which a real path leaves its line or circle …
  double slack_per_length = 0.01;     ///< … and per length
  double drift = 3 * kDegree;         ///< radians by which a marker's orientation drifts
  double min_sigma_m = 5e-5;          ///< no tracker is better
  int samples = 250;                  ///< of the sample consensus
  int em_rounds = 25;                 ///< of expectation and maximisation
  int lm_steps = 15;                  ///< of Levenberg and Marquardt per round
  double orientation_outliers = 0.1;  ///< share of orientations; markers flip
};
inline constexpr TrackParameters kTracks;

/// Fronts in general; the models of mountings are in prior.cpp.
struct PriorParameters {
  double fixed_without_fixture = 0.35;  ///< share of fronts without fixture that do not move
  double min_density = 0.004;           ///< relative to the peak: furniture may be unusual
};
inline constexpr PriorParameters kPriors;

}  // namespace loci::mapping
