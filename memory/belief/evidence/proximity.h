#pragma once

#include "memory/belief/evidence/noise_scale.h"
#include "memory/belief/options.h"

namespace loci::memory::belief {

/// Errors of the offset between a believed and an observed centre, per axis, m².
struct PositionNoise {
  double known = 0;              ///< the part of a depth sensor that stands still
  double stated = 0;             ///< the rest as the options state it
  NoiseScale::Levels weights{};  ///< of the factors on its standard deviation

  /// Density of a horizontal offset by factor, 1/m².
  NoiseScale::Levels densities(double squared_offset, double spread = 0) const;
  double log_density(double squared_offset, double spread) const;
};

/// Variance per axis (m²) of an observation's centre for a static camera.
double observation_variance(const Observation& observation, const BeliefOptions& options);

/// Translation (m) plus rotation (rad) between two camera poses.
double camera_motion(const Isometry3d& from, const Isometry3d& to);

/// Variance (m²) added by a change of view point: pose error between the views, and another side of an object
/// of this size being visible.
double view_change_variance(const Isometry3d& from, const Isometry3d& to, double size,
                            const BeliefOptions& options);

/// Likelihood ratio of where a short move ends, against anywhere on the place.
double short_move_ratio(const Vector3d& offset, const BeliefOptions& options);

/// Log-likelihood ratio of the observation's position: "the object is still at `box`" against "anywhere on a
/// place". Whole boxes are compared by their centres; a partial one only has to lie within the other,
/// and two partial ones beside each other.
/// Extents depend on the visible side even where poses are accurate: their noise is the stated one.
double log_proximity(const AxisBox& box, const PositionNoise& noise, bool box_partial,
                     const Observation& observation, const BeliefOptions& options);

}  // namespace loci::memory::belief
