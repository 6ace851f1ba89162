#include "mapping/render/depth_tiles.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace loci::mapping::render_detail {

DepthTiles::Level::Level(int side, int width, int rows)
    : across((width + side - 1) / side),
      least(static_cast<size_t>(across * ((rows + side - 1) / side)), 0.f),
      stale(least.size(), 0) {}

DepthTiles::DepthTiles(const float* inverse_depth, int width, int row_begin, int row_end)
    : image_(inverse_depth),
      width_(width),
      row_begin_(row_begin),
      row_end_(row_end),
      fine_(kFine, width, row_end - row_begin),
      coarse_(kCoarse, width, row_end - row_begin) {}

bool DepthTiles::hidden(const PixelBox& box, float inverse_depth) {
  if (box.area() <= kFewPixels)
    return least_of_pixels(box.u_first, box.u_last + 1, box.v_first, box.v_last + 1) > inverse_depth;
  const int top = box.v_first - row_begin_, bottom = box.v_last - row_begin_;
  for (int row = top / kCoarse; row <= bottom / kCoarse; ++row)
    for (int column = box.u_first / kCoarse; column <= box.u_last / kCoarse; ++column) {
      if (coarse(row, column) > inverse_depth) continue;
      const int row_end = std::min(bottom / kFine, (row + 1) * (kCoarse / kFine) - 1);
      const int column_end = std::min(box.u_last / kFine, (column + 1) * (kCoarse / kFine) - 1);
      for (int r = std::max(top / kFine, row * (kCoarse / kFine)); r <= row_end; ++r)
        for (int c = std::max(box.u_first / kFine, column * (kCoarse / kFine)); c <= column_end; ++c)
          if (!(fine(r, c) > inverse_depth)) return false;
    }
  return true;
}

void DepthTiles::changed(const PixelBox& box) {
  const auto mark = [&](Level& level, int side) {
    for (int row = (box.v_first - row_begin_) / side; row <= (box.v_last - row_begin_) / side; ++row)
      for (int column = box.u_first / side; column <= box.u_last / side; ++column)
        level.stale[static_cast<size_t>(row * level.across + column)] = 1;
  };
  mark(fine_, kFine);
  mark(coarse_, kCoarse);
}

float DepthTiles::least_of_pixels(int u_begin, int u_end, int v_begin, int v_end) const {
  float least = std::numeric_limits<float>::infinity();
  for (int v = v_begin; v < v_end; ++v) {
    const float* line = image_ + static_cast<ptrdiff_t>(v) * width_;
    for (int u = u_begin; u < u_end; ++u) least = line[u] < least ? line[u] : least;
  }
  return least;
}

float DepthTiles::fine(int row, int column) {
  const auto tile = static_cast<size_t>(row * fine_.across + column);
  if (fine_.stale[tile]) {
    fine_.stale[tile] = 0;
    const int v = row_begin_ + row * kFine, u = column * kFine;
    fine_.least[tile] = least_of_pixels(u, std::min(u + kFine, width_), v, std::min(v + kFine, row_end_));
  }
  return fine_.least[tile];
}

float DepthTiles::coarse(int row, int column) {
  const auto tile = static_cast<size_t>(row * coarse_.across + column);
  if (coarse_.stale[tile]) {
    coarse_.stale[tile] = 0;
    float least = std::numeric_limits<float>::infinity();
    const int side = kCoarse / kFine;
    const int row_end = std::min((row + 1) * side, static_cast<int>(fine_.least.size()) / fine_.across);
    for (int r = row * side; r < row_end; ++r)
      for (int c = column * side; c < std::min((column + 1) * side, fine_.across); ++c)
        least = std::min(least, fine(r, c));
    coarse_.least[tile] = least;
  }
  return coarse_.least[tile];
}

}  // namespace loci::mapping::render_detail
