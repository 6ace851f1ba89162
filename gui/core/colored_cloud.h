#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace loci::gui {

/// Points with a colour each, map frame.
struct ColoredCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::array<uint8_t, 3>> colors;  ///< red, green, blue; one per point
};

}  // namespace loci::gui
