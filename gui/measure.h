#pragma once

#include <QApplication>
#include <chrono>
#include <string>

namespace loci::gui {

class MainWindow;

/// Counts as drawing what the thread of the windows does while one of these lives.
class DrawingScope {
 public:
  DrawingScope();
  ~DrawingScope();
  DrawingScope(const DrawingScope&) = delete;
  DrawingScope& operator=(const DrawingScope&) = delete;
};

/// What kept the thread of the windows busy for longest, drawing left out.
struct LongestTask {
  double ms = 0;
  double cpu_ms = 0;      ///< of it, processor time: without what other programs took
  std::string what = {};  ///< the last name given by name_task(), else the receiver's class and its event
};

/// Says what the thread of the windows is doing, for whoever asks what takes long.
void name_task(const std::string& what);

/// An application that knows how long its thread was ever busy with one thing, drawing left out.
class TimedApplication : public QApplication {
 public:
  using QApplication::QApplication;

  bool notify(QObject* receiver, QEvent* event) override;
  /// Since the last call of this.
  LongestTask take_longest_task();

 private:
  int depth_ = 0;
  LongestTask longest_;
};

/// What a person waits for.
struct WindowFigures {
  double open_s = 0;        ///< from the wish to open the file to the first image with everything in it
  double frames_per_s = 0;  ///< while the time is scrubbed
  double frame_median_ms = 0, frame_p95_ms = 0;  ///< from one new moment on the screen to the next
  size_t frames = 0;
  double frame_cpu_ms =
      0;  ///< processor time of all threads per frame, which does not depend on other programs
  LongestTask open_task, scrub_task, select_task;  ///< for which the window did not answer
};

/// Opens a memory in a window, drags the time from its beginning to its end for some seconds as a mouse would
/// (125 positions a second), chooses ten objects and looks at all docks. Error when the file cannot be
/// opened.
WindowFigures measure_window(TimedApplication& application, MainWindow& window, const std::string& file,
                             double seconds);
std::string text_of(const WindowFigures& figures);

}  // namespace loci::gui
