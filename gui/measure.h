#pragma once

#include <QApplication>
#include <chrono>
#include <string>

namespace loci {

class MainWindow;

/// Counts as drawing what the thread of the windows does while one of these lives.
class DrawingScope {
 public:
  DrawingScope();
  ~DrawingScope();
  DrawingScope(const DrawingScope&) = delete;
  DrawingScope& operator=(const DrawingScope&) = delete;
};

/// An application that knows how long its thread was ever busy with one thing, drawing left out.
class TimedApplication : public QApplication {
 public:
  using QApplication::QApplication;

  bool notify(QObject* receiver, QEvent* event) override;
  /// Since the last call of this.
  double take_longest_task_ms();

 private:
  int depth_ = 0;
  double longest_ms_ = 0;
};

/// What a person waits for.
struct WindowFigures {
  double open_s = 0;        ///< from the wish to open the file to the first picture with everything in it
  double frames_per_s = 0;  ///< while the time is scrubbed
  double frame_median_ms = 0, frame_p95_ms = 0;  ///< from one new moment on the screen to the next
  size_t frames = 0;
  double open_task_ms = 0, scrub_task_ms = 0, select_task_ms = 0;  ///< longest that the window did not answer
};

/// Opens a memory in a window, drags the time from its beginning to its end for some seconds as a mouse would
/// (125 positions a second), chooses ten objects and looks at all docks. Error when the file cannot be
/// opened.
WindowFigures measure_window(TimedApplication& application, MainWindow& window, const std::string& file,
                             double seconds);
std::string text_of(const WindowFigures& figures);

}  // namespace loci
