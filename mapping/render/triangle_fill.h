#pragma once

#include <Eigen/Core>

#include "mapping/render/pixel_bounds.h"
#include "mapping/render/rasterizer.h"

namespace loci::mapping::render_detail {

/// A triangle as it is filled: its corners as homogeneous pixel positions (fx·X, fy·Y, Z).
struct PlacedTriangle {
  Eigen::Vector3d corners[3];
  double w_low, w_high;  ///< 1/z lies between those of the corners
  bool clipped;          ///< crosses the near plane: what lies beyond the range is cut off, not held
  uint64_t id;
};

/// Writes triangles into the pixels that they cover.
class TriangleFill {
 public:
  TriangleFill(const PinholeCamera& camera, const DrawOptions& options, Raster& raster)
      : camera_(camera), w_near_(1 / options.near_m), w_far_(1 / options.far_m), raster_(raster) {}

  /// Considers the pixels of a box only. Whether something was written.
  bool fill(const PlacedTriangle& triangle, const PixelBox& box);

 private:
  struct Edge;
  struct Plane;

  bool write(const Plane& plane, double row_w, int u, float* inverse_depth, uint64_t* id) const;
  bool write_lanes(const Plane& plane, double row_w, int u, float* inverse_depth, uint64_t* id) const;
  void narrow(const Edge& edge, double row_value, int& first, int& last) const;
  bool fill_small(const Edge* edges, double determinant, const PlacedTriangle& triangle, const PixelBox& box);
  bool fill_spans(const Edge* edges, const Plane& plane, const PixelBox& box);

  const PinholeCamera& camera_;
  double w_near_, w_far_;
  Raster& raster_;
};

}  // namespace loci::mapping::render_detail
