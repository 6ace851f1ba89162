#pragma once

#include <cstdint>
#include <string_view>

namespace loci::mapping {

/// What the map says about a pixel of a depth image (Fig. 2.1). The values are those of the `structure` view
/// of a scene and of the memory's `scene.kinds`.
enum class PixelKind : uint8_t {
  unmeasured = 0,
  map_explained = 1,       ///< on a surface of the map or of a robot
  background = 2,          ///< in no region of interest
  region_of_interest = 3,  ///< above a support of the map
};
inline constexpr int kPixelKinds = 4;

constexpr std::string_view to_text(PixelKind kind) {
  switch (kind) {
    case PixelKind::map_explained:
      return "map-explained";
    case PixelKind::background:
      return "background";
    case PixelKind::region_of_interest:
      return "region of interest";
    case PixelKind::unmeasured:
      break;
  }
  return "unmeasured";
}

}  // namespace loci::mapping
