#pragma once

#include "gui/data/browser_data.h"
#include "gui/scene3d/colored_cloud.h"

namespace loci::gui {

/// What the scene's image shows at a point (depth camera's frame): red, green, blue; grey without a
/// image.
std::array<uint8_t, 3> color_at(const SceneContent& content, const Vector3d& in_camera);

/// The measured points of a scene in the map frame with the colours of its image (grey without one), at
/// most `limit` of them, taken in even steps. Empty without depth or pose.
ColoredCloud frame_cloud(const SceneContent& content, size_t limit);

}  // namespace loci::gui
