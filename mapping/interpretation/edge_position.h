#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "mapping/interpretation/plane_raster.h"

namespace loci::mapping {

/// How far off an edge may be before it is sharpened, metres.
inline constexpr double kEdgeWindow = 0.06;

/// Positions across an edge, outwards, within kEdgeWindow of where it is thought to be.
struct EdgeSamples {
  std::vector<double> rim;      ///< points right below the top: of the slab's vertical edge
  std::vector<double> support;  ///< points of the top
  std::vector<double> brink;    ///< points at its height with uncertain normals
  std::vector<double> passed;   ///< crossings of rays that passed beside it
};

/// Samples across an edge, given how far out of it a point of the map lies; unset = beside the edge.
template <class Outwards>
EdgeSamples samples_across(const PlaneEvidence& evidence, const Outwards& outwards) {
  EdgeSamples samples;
  const auto add = [&](const Vector2d& point, std::vector<double>& list) {
    const double value = outwards(point);
    if (std::abs(value) < kEdgeWindow) list.push_back(value);
  };
  for (const Vector2d& point : evidence.rim) add(point, samples.rim);
  for (const auto& point : evidence.support) add(point.position, samples.support);
  for (const auto& point : evidence.brink) add(point.position, samples.brink);
  for (const Vector2d& point : evidence.pierced) add(point, samples.passed);
  for (const Vector2d& point : evidence.sunk) add(point, samples.passed);
  return samples;
}

/// Where the edge is, relative to where it was thought to be, metres: the slab's vertical edge where it was
/// seen, otherwise what parts surface from rays that passed; unset where neither is clear, or where the edge
/// would grow over a strip in which the top itself was not seen. `length` is the edge's, metres.
std::optional<double> edge_position(const EdgeSamples& samples, double length);

}  // namespace loci::mapping
