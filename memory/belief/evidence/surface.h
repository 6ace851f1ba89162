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
  unknown,       ///< out of view, or not measured
  seen_through,  ///< all around it what lies behind is measured: it is not there any more
};
/// `pose_error_m`: between the view that measured them and this one.
std::vector<PointState> observe_surface(const SceneView& view, const Surface& points, double pose_error_m,
                                        const VisibilityOptions& options = {});

/// Share of the points that are not there any more, of those about which the view tells; unset where it tells
/// of too few.
std::optional<double> displaced_share(const std::vector<PointState>& states);

/// Log-likelihood ratio of that share: "the object has not moved" against "moved to near its former spot".
/// Never above 0: that nothing is displaced tells as much as the error of the poses is small.
double surface_log_ratio(double displaced);

}  // namespace loci::memory::belief
