#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "mapping/sensor/camera.h"

namespace loci::render_detail {

/// A piece of a link's surface: few enough triangles that culling it as a whole is worth the test.
struct Chunk {
  std::vector<Eigen::Vector3f> vertices;  ///< link frame, metres
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<std::array<uint8_t, 3>> colors;        ///< RGB, one for all or one per triangle
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the bounding sphere, link frame
  double radius = 0;
  size_t link = 0;              ///< link id
  uint32_t first_triangle = 0;  ///< number of its first triangle in the scene; grows with the link id
};

/// A chunk that may be seen, and where.
struct PlacedChunk {
  const Chunk* chunk = nullptr;
  const Eigen::Isometry3d* camera_from_link = nullptr;
};

constexpr uint32_t kNoTriangle = std::numeric_limits<uint32_t>::max();

/// What was drawn, per pixel, row by row.
struct Raster {
  std::vector<float> inverse_depth;  ///< 1/z, 0 = nothing
  std::vector<uint32_t> triangle;    ///< scene number of the triangle, kNoTriangle = nothing
};

/// Draws rows [row_begin, row_end) of the picture. Pixels depend on the chunks only, not on their order nor
/// on how rows are shared out: the nearest surface wins, of equally near ones the triangle with the lowest
/// number. A pixel whose centre lies on an edge that two triangles share belongs to exactly one of them.
void draw_rows(const std::vector<PlacedChunk>& chunks, const PinholeCamera& camera, double near_m,
               double far_m, int row_begin, int row_end, Raster& raster);

}  // namespace loci::render_detail
