#pragma once

#include <array>
#include <optional>

#include "gui/data/browser_data.h"

namespace loci::gui {

/// What was measured at a pixel of a scene's images.
struct PixelValues {
  std::optional<double> depth = {};                  ///< metres along the depth camera's axis
  std::optional<std::array<uint8_t, 3>> color = {};  ///< red, green, blue
  std::optional<Vector3d> position = {};             ///< map frame
};

/// `pixel` is one of the camera's colour image, or of its depth image (which may be stored smaller). What
/// belongs to a colour pixel is looked for in the depth image, between which the cameras' offset counts.
PixelValues values_at_color(const SceneContent& content, const Vector2d& pixel);
PixelValues values_at_depth(const SceneContent& content, const Vector2d& pixel);

}  // namespace loci::gui
