#pragma once

#include <array>

namespace loci::gui {

/// Red, green, blue in [0,1], as VTK takes them.
using SceneColor = std::array<double, 3>;

/// What the 3D view is painted with; follows the palette of the window.
struct SceneColors {
  SceneColor background_top = {0.93, 0.94, 0.96};
  SceneColor background_bottom = {0.80, 0.83, 0.87};
  SceneColor world = {0.78, 0.77, 0.75};  ///< links without a material
  SceneColor edges = {0.36, 0.36, 0.37};  ///< opaque: translucent lines cost a pass over the whole image
  SceneColor label_text = {0.08, 0.09, 0.10};
  SceneColor label_back = {1, 1, 1};
  SceneColor accent = {0.00, 0.45, 0.85};  ///< the selection
  SceneColor frustum = {0.85, 0.45, 0.05};
  SceneColor ruler = {0.80, 0.10, 0.55};

  double pixels = 1;  ///< of the screen for one of the window: letters, lines and points grow with it

  static SceneColors light() { return {}; }
  static SceneColors dark() {
    return {{0.17, 0.18, 0.20}, {0.09, 0.10, 0.11}, {0.62, 0.62, 0.61},
            {0.16, 0.16, 0.17}, {0.95, 0.96, 0.97}, {0.10, 0.11, 0.12},
            {0.35, 0.70, 1.00}, {1.00, 0.65, 0.25}, {1.00, 0.45, 0.80}};
  }
};

}  // namespace loci::gui
