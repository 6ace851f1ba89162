#pragma once

#include "gui/data/browser_data.h"

namespace loci::gui {

/// What the pixels of the colour image are (CV_8U, mapping::PixelKind, as many pixels as the depth image
/// has), by way of the depth that was measured there. Empty when it is not known.
cv::Mat kinds_in_color(const SceneContent& content);

}  // namespace loci::gui
