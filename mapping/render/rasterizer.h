#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "mapping/render/surface.h"
#include "mapping/sensor/camera.h"

namespace loci::mapping::render_detail {

/// A surface somewhere: a link's, and how it lies before the camera.
struct PlacedSurface {
  const Surface* surface = nullptr;
  const Eigen::Isometry3d* camera_from_link = nullptr;
  uint32_t number = 0;  ///< of the instance in the scene; grows with the link id
};

/// Which triangle of which instance: numbers in the order in which ties are decided.
constexpr uint64_t surface_id(uint32_t instance, uint32_t triangle) {
  return static_cast<uint64_t>(instance) << 32 | triangle;
}
constexpr uint32_t instance_of(uint64_t id) {
  return static_cast<uint32_t>(id >> 32);
}
constexpr uint32_t triangle_of(uint64_t id) {
  return static_cast<uint32_t>(id);
}
constexpr uint64_t kNothing = std::numeric_limits<uint64_t>::max();

/// What was drawn, per pixel, row by row.
struct Raster {
  std::vector<float> inverse_depth;  ///< 1/z, 0 = nothing
  std::vector<uint64_t> id;          ///< surface_id, kNothing = nothing
};

struct DrawOptions {
  double near_m = 0.05, far_m = 100;
  bool occlusion_culling = true;  ///< what is hidden is passed over; the pixels are the same without
};

/// Draws rows [row_begin, row_end) of the image; fastest when the surfaces come nearest first. Pixels
/// depend on the surfaces only, not on their order nor on how rows are shared out: the nearest surface wins,
/// of equally near ones the lowest number. A pixel whose centre lies on an edge that two triangles share
/// belongs to exactly one of them.
void draw_rows(const std::vector<PlacedSurface>& surfaces, const PinholeCamera& camera,
               const DrawOptions& options, int row_begin, int row_end, Raster& raster);

}  // namespace loci::mapping::render_detail
