#pragma once

#include <cstddef>
#include <cstdint>

#include "mapping/render/surface.h"

namespace loci::mapping::render_detail {

/// From vertices of a link to the image: rows of (fx·X, fy·Y, Z), the principal point and how far pixels
/// count beyond the image's edges.
struct Projection {
  double m[3][4];
  double cx, cy;
  double u_limit, v_limit;  ///< positions are held to [-2, limit]: outside it does not matter where
};

/// The pixels around a position: its first column, its last one negated, first row, last row negated, so that
/// the pixels around several positions are the smallest of each, four comparisons at a time. They are held to
/// images of at most kMaxSide pixels a side.
using PixelReach [[gnu::vector_size(8)]] = int16_t;
constexpr int kMaxSide = 32000;

/// The corners of a cluster before the camera; all arrays by vertex. Pixels whose centre a triangle can cover
/// are those in the reach of its corners: positions are rounded outwards by a millionth of a pixel, as the
/// edge functions decide exactly.
struct PlacedVertices {
  double x[Cluster::kVertices], y[Cluster::kVertices], z[Cluster::kVertices];  ///< (fx·X, fy·Y, Z)
  double w[Cluster::kVertices];                                                ///< 1/Z
  PixelReach reach[Cluster::kVertices];
};

/// Places vertices. The projections are meaningless for those that are not in front of the camera.
void place_vertices(const float* x, const float* y, const float* z, size_t count,
                    const Projection& projection, PlacedVertices& placed);

}  // namespace loci::mapping::render_detail
