#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/plane_raster.h"
#include "mapping/interpretation/supports/supports.h"

namespace loci::mapping {

// The steps of find_supports() after the search for rectangles.

/// Fraction of the first rectangle of `inner` within `outer`, sampled at `steps` per side.
double covered_fraction(const Support& inner, const Support& outer, int steps, double margin = 0);

/// The yaw of a support's axes, from its own edges. The room's where they lie along it within the noise, or
/// too little surface was seen. `seed`: points of the surface.
double support_yaw(const PlaneEvidence& evidence, const std::vector<Vector2d>& seed, double room_yaw);

/// Measures a support whose rectangles are roughly known: exact edges and their kinds, height (median over
/// scans), areas, inliers, scans, walls.
void measure(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster,
             const std::vector<VerticalPlane>& walls, const Surface& surface);

/// Extends rectangles behind objects that stand on a slab from edge to edge: if, beyond a side, only the
/// object and the slab's edge below it are seen until there is surface again, and one front continues below,
/// the rectangle reaches to the end of that surface. Never across cells through which rays passed.
void extend_behind_objects(Support& support, const PlaneEvidence& evidence,
                           const std::vector<VerticalPlane>& faces);

/// Replaces rectangles by a circle or a polygon where that fits clearly better: round tables, slanted sides.
void fit_outline(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster);

/// Adds counters whose tops were hardly seen (depth cameras measure nothing on black gloss): where a
/// furniture face with a level upper edge stands before a wall, pieces of surface confirm the height, and no
/// ray passed through. Removes supports that such a counter explains.
void add_counters_behind_faces(std::vector<Support>& supports, const Surface& surface,
                               const std::vector<VerticalPlane>& faces,
                               const std::vector<VerticalPlane>& walls, double floor_height);

/// Assigns classes to supports; drops seats and surfaces that stand on others, with a note for each.
void classify(SupportSearch& search, const Surface& surface, double floor_height);

/// Positions across an edge, outwards, within kEdges.window_m of the assumed edge.
struct EdgeSamples {
  std::vector<double> rim;        ///< points of the slab's vertical edge
  std::vector<double> support;    ///< points of the top
  std::vector<double> uncertain;  ///< points at its height with uncertain normals
  std::vector<double> passed;     ///< crossings of rays that passed beside it
};

/// Samples across an edge; `outwards` maps a point of the map to its signed distance from the edge.
template <class Outwards>
EdgeSamples samples_across(const PlaneEvidence& evidence, const Outwards& outwards) {
  EdgeSamples samples;
  const auto add = [&](const Vector2d& point, std::vector<double>& list) {
    const double value = outwards(point);
    if (std::abs(value) < kEdges.window_m) list.push_back(value);
  };
  for (const Vector2d& point : evidence.rim) add(point, samples.rim);
  for (const auto& point : evidence.support) add(point.position, samples.support);
  for (const auto& point : evidence.uncertain) add(point.position, samples.uncertain);
  for (const Vector2d& point : evidence.pierced) add(point, samples.passed);
  for (const Vector2d& point : evidence.sunk) add(point, samples.passed);
  return samples;
}

/// Position of the edge relative to the assumed one, metres: the slab's vertical edge where it was seen,
/// otherwise the line that separates surface from passing rays. Unset where neither is clear, or where the
/// top would grow over a strip in which it was not seen. `length`: of the edge, metres.
std::optional<double> edge_position(const EdgeSamples& samples, double length);

}  // namespace loci::mapping
