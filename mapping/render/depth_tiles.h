#pragma once

#include <cstdint>
#include <vector>

#include "mapping/render/pixel_bounds.h"

namespace loci::mapping::render_detail {

/// How far away the farthest pixel of a tile is, on two levels, for a band of an image of inverse depths.
/// Levels are brought up to date only where somebody asks.
class DepthTiles {
 public:
  /// `inverse_depth`: the whole image, row by row; the band is its rows [row_begin, row_end).
  DepthTiles(const float* inverse_depth, int width, int row_begin, int row_end);

  /// Whether everything drawn so far in these pixels is nearer than `inverse_depth`.
  bool hidden(const PixelBox& box, float inverse_depth);
  /// Says that pixels of this box have become nearer.
  void changed(const PixelBox& box);

 private:
  static constexpr int kFine = 8, kCoarse = 32;  ///< side of a tile, pixels
  static constexpr int kFewPixels = 48;          ///< smaller boxes are looked at pixel by pixel

  /// The smallest inverse depth of tiles; older than the image where stale.
  struct Level {
    int across = 0;
    std::vector<float> least;
    std::vector<uint8_t> stale;

    Level(int side, int width, int rows);
  };

  float least_of_pixels(int u_begin, int u_end, int v_begin, int v_end) const;
  float fine(int row, int column);
  float coarse(int row, int column);

  const float* image_;
  int width_, row_begin_, row_end_;
  Level fine_, coarse_;
};

}  // namespace loci::mapping::render_detail
