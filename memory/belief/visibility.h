#pragma once

#include <vector>

#include "memory/belief/observation.h"

namespace loci::memory::belief {

/// What became of looking at a place: shares of the lines of sight to points of a box, summing to one.
struct Visibility {
  double out_of_view = 0;   ///< beside the image, or nearer or farther than the sensor measures
  double hidden = 0;        ///< something was measured, or the map stands, in front of it
  double unmeasured = 0;    ///< in the image, but the sensor gave nothing (glossy, dark, shadow)
  double occupied = 0;      ///< a surface was measured where it is
  double seen_through = 0;  ///< the sensor looked through the place to something behind: it is not there
  double searched = 0;      ///< a detector that knows no depth looked there and found nothing

  /// Share of the box about which the image says something.
  double looked() const { return occupied + seen_through + searched; }
  /// Of what was looked at, the share that was seen empty; 0 when nothing was looked at.
  double empty_share() const { return looked() > 0 ? seen_through / looked() : 0.0; }
};

struct VisibilityOptions {
  int steps = 5;              ///< sample points along each side of the box
  double core = 0.7;          ///< sampled part of the box's width and depth: corners of boxes are often empty
  double tolerance_m = 0.01;  ///< of depths, at one metre and below
  double tolerance_per_m2 = 0.004;  ///< growth of the tolerance with the square of the depth
};

/// What the view tells about a box at `box` (map frame) whose centre is known to ± `sigma` metres.
Visibility look_at(const SceneView& view, const AxisBox& box, double sigma,
                   const VisibilityOptions& options = {});

/// Like look_at(), and which observation's pixels were met where the place is occupied: shares per
/// observation of view.labels (empty without labels).
struct OccupiedBy {
  Visibility visibility;
  std::vector<double> share;
};
OccupiedBy look_at_who(const SceneView& view, const AxisBox& box, double sigma, size_t observations,
                       const VisibilityOptions& options = {});

/// The same for a view without depth: where its detector looked, and what it found there.
OccupiedBy look_without_depth(const SceneView& view, const AxisBox& box, const std::string& place,
                              const std::vector<Observation>& found, const VisibilityOptions& options = {});

/// Probability that something there would go undetected because too little of it is in view.
double undetectable(const Visibility& visibility);

/// Share of a flat outline (map frame, closed polygon at one height) that the camera measured: neither out of
/// view nor hidden. Sampled on a grid of `step_m`.
double observed_fraction(const SceneView& view, const std::vector<Vector3d>& outline, double step_m = 0.05,
                         const VisibilityOptions& options = {});

}  // namespace loci::memory::belief
