#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/registration/surfels.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A front that stands open, as its known joint takes it.
struct OpenLeaf {
  double position = 0;            ///< of the joint, metres or radians
  std::vector<uint32_t> surfels;  ///< of its panel, and of what it opens: a drawer, or the inside
  size_t on_panel = 0;            ///< of these
};

/// Whether some surfels show a front at a position that its joint can take; unset where they cover less than
/// `min_share` of the panel at each of them, or where its joint is not known.
std::optional<OpenLeaf> open_leaf(const Front& front, const registration::Surfels& surface,
                                  const std::vector<uint32_t>& candidates, double min_share);

}  // namespace loci::mapping
