#pragma once

#include "memory/belief/options.h"
#include "memory/belief/state.h"

namespace loci::memory::belief {

/// Variance per axis (m²) of an observation's centre when the camera stands still.
double observation_variance(const Observation& observation, const BeliefOptions& options);

/// Variance (m²) that a change of view point adds: error of the pose between the views, and another side of
/// an object of this size being visible.
double view_change_variance(const Isometry3d& from, const Isometry3d& to, double size,
                            const BeliefOptions& options);

/// Log-likelihood ratio of the observation's position: "the object is still at `box`" against "anywhere on a
/// place". Centres are compared where both are whole; what is cut off only has to lie within the other's box.
/// `extent_variance` is that of the extents, which depend on what side is visible even where poses are good.
double log_proximity(const AxisBox& box, double variance, double extent_variance, bool box_partial,
                     const Observation& observation, const BeliefOptions& options);

}  // namespace loci::memory::belief
