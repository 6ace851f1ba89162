#pragma once

#include <vector>

#include "mapping/interpretation/surface.h"

namespace loci::mapping {

/// Upward points of one small column of space that lie at one height.
struct LayerCell {
  int x = 0, y = 0;  ///< column
  float height = 0;  ///< median
  int count = 0;
  int component = -1;
};

/// Connected pieces of upward surface.
struct Layers {
  double cell = 0.02;  ///< side of a column, metres
  std::vector<LayerCell> cells;
  std::vector<std::vector<uint32_t>> components;  ///< cells of each piece, largest piece first
};

/// Whether a point looks up enough to carry something.
inline bool looks_up(const SurfacePoint& point) {
  return point.normal.z() > 0.94F;
}

/// Whether a point may be of a surface like that although its normal does not say so: near a vertical surface
/// the neighbourhood that a normal is taken from holds both, and a few rows of points give none.
inline bool may_look_up(const SurfacePoint& point) {
  return !looks_up(point) && (point.normal.isZero() || point.normal.z() > 0.3F);
}

/// Upward points between two heights, by column and height, grown into pieces whose height changes little
/// from column to column.
Layers find_layers(const Surface& surface, double lowest, double highest);

}  // namespace loci::mapping
