#pragma once

#include <optional>
#include <vector>

#include "memory/belief/evidence/visibility.h"
#include "memory/belief/scene.h"

namespace loci::memory::belief {

/// Points on the visible surface of an object, metres.
using Surface = std::vector<Eigen::Vector3f>;

/// Points of each observation, at most `most` of one, map frame; without depth or labels none.
std::vector<Surface> sample_surfaces(const SceneView& view, size_t observations, size_t most);

/// What a view shows of a point that was once measured.
enum class PointState {
  there,         ///< a surface is measured at its depth
  hidden,        ///< something is before it
  unknown,       ///< out of view, hardly measured, or not to be told from what the object stands on
  seen_through,  ///< all that is measured around it lies behind it: it is not there any more
};
/// `support_z`: height of what the object stands on, map frame. `pose_error_m`: between the view that
/// measured the points and this one.
std::vector<PointState> observe_surface(const SceneView& view, const Surface& points, double support_z,
                                        double pose_error_m, const VisibilityOptions& options = {});

/// Share of the points that are not there any more, of those about which the view tells; unset where it tells
/// of too few.
std::optional<double> displaced_share(const std::vector<PointState>& states);

/// Log-likelihood ratio of that share: "the object has not moved" against "it is not where it was". Where
/// nothing is displaced it tells little: something like it may stand there, or it moved by less than the
/// error of the poses.
double surface_log_ratio(double displaced);

}  // namespace loci::memory::belief
