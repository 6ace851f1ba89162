#pragma once

#include <vector>

#include "mapping/interpretation/surface.h"
#include "mapping/interpretation/walls.h"

namespace loci::mapping {

/// What the rays say about a vertical plane, as fractions of its columns or cells.
struct RayEvidence {
  double looked_over = 0;  ///< columns above whose top rays crossed the plane
  double passed_over = 0;  ///< columns above whose top rays crossed it and ended on something behind it
  double pierced = 0;      ///< cells, of those that were seen or crossed, that rays crossed
};

/// Rays against planes, each plane on its own. Same result on any number of threads.
std::vector<RayEvidence> ray_evidence(const Surface& surface, const std::vector<VerticalPlane>& planes,
                                      int threads);

/// Fits a plane anew to all its points but those near its ends, where it meets other planes: surfels there
/// mix both.
void polish(VerticalPlane& plane, const Surface& surface);

/// Whether something small stands out before a plane, as handles and knobs do.
bool has_fixtures(const Surface& surface, const VerticalPlane& plane);

}  // namespace loci::mapping
