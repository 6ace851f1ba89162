#pragma once

#include <optional>
#include <vector>

namespace loci {

/// How far off an edge may be before it is sharpened, metres.
inline constexpr double kEdgeWindow = 0.06;

/// Positions across an edge, outwards, within kEdgeWindow of where it is thought to be.
struct EdgeSamples {
  std::vector<double> rim;      ///< points right below the top: of the slab's vertical edge
  std::vector<double> support;  ///< points of the top
  std::vector<double> passed;   ///< crossings of rays that passed beside it
};

/// Where the edge is, relative to where it was thought to be, metres: the slab's vertical edge where it was
/// seen, otherwise what parts surface from rays that passed; unset where neither is clear. `length` is the
/// edge's, metres.
std::optional<double> edge_position(const EdgeSamples& samples, double length);

}  // namespace loci
