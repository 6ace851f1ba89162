#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gui/core/theme.h"

namespace loci::gui {

/// What to open and how.
struct BrowseOptions {
  std::string file;                   ///< memory; may be empty for a window
  std::string screenshot;             ///< PNG to write instead of staying; empty = a window
  std::string at;                     ///< time to show, as people write it; empty = the last scene
  std::string select;                 ///< object or place to select; empty = none
  std::string ask;                    ///< question to ask in the question bar; empty = none
  std::string beside = {};            ///< time, or memory, whose map stands beside the map; empty = none
  std::string room = {};              ///< coloured mesh of the room (PLY) to draw; empty = none
  std::vector<std::string> run = {};  ///< actions of the menus, by name
  std::string show;                   ///< dock to bring to the front; empty = as it was
  double measure_s = 0;  ///< seconds for which the window is measured instead of staying; 0 = not
  std::function<void(const std::string&)> print = {};  ///< where the figures go
  std::string size = "1280x800";
  std::string view = "window";         ///< what the image shows: the whole "window", or the "map" alone
  std::vector<std::string> hide = {};  ///< layers of the 3D view that the image leaves out
  ThemeChoice theme = ThemeChoice::system;
  bool has_screen = true;   ///< there is an X or Wayland display
  bool has_desktop = true;  ///< whose palette and font are taken
};

/// Runs the browser until its window is closed, or writes one image; returns the exit code. Error when the
/// memory cannot be read, when nothing can be drawn, or when a window is wanted and there is no screen.
int run_browser(const BrowseOptions& options, const std::string& program);

}  // namespace loci::gui
