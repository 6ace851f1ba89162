#pragma once

#include <vector>

#include "memory/belief/scene.h"

namespace loci::memory::belief {

/// Result of observing a box: shares of the lines of sight to points of it, summing to one.
struct Visibility {
  double out_of_view = 0;   ///< outside the image or the measuring range
  double hidden = 0;        ///< occluded by a measurement or by the map
  double unmeasured = 0;    ///< in the image, but without measurement (glossy, dark, shadow)
  double occupied = 0;      ///< a surface was measured in the box
  double seen_through = 0;  ///< something behind the box was measured: the spot is empty
  double searched = 0;      ///< a detector without depth observed it and reported nothing

  /// Share about which the scene carries information.
  double observed() const { return occupied + seen_through + searched; }
  /// Of the observed part, the share that is empty; 0 when nothing was observed.
  double empty_share() const { return observed() > 0 ? seen_through / observed() : 0.0; }
};

struct VisibilityOptions {
  int steps = 5;              ///< sample points along each side of the box
  double core = 0.7;          ///< sampled part of the box's width and depth: corners of boxes are often empty
  double tolerance_m = 0.01;  ///< of depths, at one metre and below
  double tolerance_per_m2 = 0.004;  ///< growth of the tolerance with the square of the depth
};

/// Visibility of a box (map frame) whose centre is known to ± `sigma` metres.
Visibility visibility_of(const SceneView& view, const AxisBox& box, double sigma,
                         const VisibilityOptions& options = {});

/// Visibility of a box, and which observations' pixels occupy it.
struct BoxVisibility {
  Visibility visibility;
  std::vector<double> occupied_by;  ///< shares per observation of view.labels (empty without labels)
};
BoxVisibility box_visibility(const SceneView& view, const AxisBox& box, double sigma, size_t observations,
                             const VisibilityOptions& options = {});

/// The same for a view without depth, from where its detector searched and what it found.
BoxVisibility box_visibility_without_depth(const SceneView& view, const AxisBox& box, double sigma,
                                           const std::string& place, const std::vector<Observation>& found,
                                           const VisibilityOptions& options = {});

/// Probability that an object in the box is not detected because too little of it is in view, so many seconds
/// after the last scene: frames of a video follow at once.
double undetectable(const Visibility& visibility, double seconds);

/// Probability that an object in a box of which nothing is hidden is told from the noise of the depth, seen
/// with the camera of a view from `map_from_camera`: whether enough pixels show it.
double resolved(const SceneView& view, const Isometry3d& map_from_camera, const AxisBox& box);

/// Share of a flat outline (map frame, closed polygon at one height) that was measured: neither out of view
/// nor hidden. Sampled on a grid of `step_m`.
double observed_fraction(const SceneView& view, const std::vector<Vector3d>& outline, double step_m = 0.05,
                         const VisibilityOptions& options = {});

}  // namespace loci::memory::belief
