#pragma once

#include <string>

#include "gui/core/task_timer.h"

namespace loci::gui {

class MainWindow;

/// What a person waits for.
struct WindowFigures {
  double open_s = 0;        ///< from the request to open the file to the first image with everything in it
  double frames_per_s = 0;  ///< while the time is scrubbed
  double frame_median_ms = 0, frame_p95_ms = 0;  ///< from one new moment on the screen to the next
  size_t frames = 0;
  double frame_cpu_ms = 0;                         ///< CPU time of all threads per frame
  LongestTask open_task, scrub_task, select_task;  ///< for which the window did not respond
};

/// Opens a memory in a window, drags the time from its beginning to its end for some seconds as a mouse would
/// (125 positions a second), selects ten objects and shows each dock. Error when the file cannot be opened.
WindowFigures benchmark_window(TimedApplication& application, MainWindow& window, const std::string& file,
                               double seconds);
std::string to_text(const WindowFigures& figures);

}  // namespace loci::gui
