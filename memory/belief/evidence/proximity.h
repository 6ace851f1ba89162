#pragma once

#include "memory/belief/options.h"

namespace loci::memory::belief {

/// Variance per axis (m²) of an observation's centre for a static camera.
double observation_variance(const Observation& observation, const BeliefOptions& options);

/// Translation (m) plus rotation (rad) between two camera poses.
double camera_motion(const Isometry3d& from, const Isometry3d& to);

/// Variance (m²) added by a change of view point: pose error between the views, and another side of an object
/// of this size being visible.
double view_change_variance(const Isometry3d& from, const Isometry3d& to, double size,
                            const BeliefOptions& options);

/// Log-likelihood ratio of the observation's position: "the object is still at `box`" against "anywhere on a
/// place". Whole boxes are compared by their centres; a partial one only has to lie within the other.
/// `extent_variance` is that of the extents, which depend on the visible side even where poses are accurate.
double log_proximity(const AxisBox& box, double variance, double extent_variance, bool box_partial,
                     const Observation& observation, const BeliefOptions& options);

}  // namespace loci::memory::belief
