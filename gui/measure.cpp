#include "gui/measure.h"

#include <fmt/format.h>

#include <QElapsedTimer>
#include <QEvent>
#include <QEventLoop>
#include <QTimer>
#include <algorithm>
#include <optional>
#include <vector>

#include "gui/background.h"
#include "gui/main_window.h"

namespace loci {
namespace {

constexpr int kMouseMs = 8;
constexpr int kObjects = 10;
constexpr int kOpenTimeoutMs = 120000;

using Clock = std::chrono::steady_clock;

int drawing_depth = 0;
Clock::time_point drawing_since;
double drawn_ms = 0;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool draws(QEvent::Type type) {
  return type == QEvent::Paint || type == QEvent::UpdateRequest || type == QEvent::Expose ||
         type == QEvent::UpdateLater;
}

void run_for(double ms) {
  QEventLoop loop;
  QTimer::singleShot(static_cast<int>(ms), &loop, &QEventLoop::quit);
  loop.exec();
}

/// Until nothing is read any more.
void settle(MainWindow& window) {
  do run_for(30);
  while (window.browser().reader().waiting() > 0 || window.loader().is_loading());
}

void scrub(MainWindow& window, double seconds, WindowFigures& figures) {
  const auto& scenes = window.browser().data()->scenes();
  if (scenes.size() < 2) return;
  std::vector<double> intervals;
  QElapsedTimer clock, since_frame;
  TimeNs shown = 0;
  const auto connection = QObject::connect(&window.map_view(), &MapView::drawn, &window, [&] {
    const TimeNs now = window.browser().belief().time;
    if (std::exchange(shown, now) == now) return;  // drawn again without anything new
    intervals.push_back(static_cast<double>(since_frame.nsecsElapsed()) / 1e6);
    since_frame.restart();
  });
  QTimer mouse;
  mouse.setTimerType(Qt::PreciseTimer);
  QObject::connect(&mouse, &QTimer::timeout, &window, [&] {
    const double part = std::min(1.0, static_cast<double>(clock.elapsed()) / 1000 / seconds);
    const auto at = static_cast<size_t>(part * static_cast<double>(scenes.size() - 1));
    window.browser().selection().set_time(scenes[at].time);
  });
  clock.start();
  since_frame.start();
  mouse.start(kMouseMs);
  run_for(seconds * 1000);
  mouse.stop();
  QObject::disconnect(connection);
  if (intervals.empty()) return;
  figures.frames = intervals.size();
  figures.frames_per_s = static_cast<double>(intervals.size()) / seconds;
  std::sort(intervals.begin(), intervals.end());
  figures.frame_median_ms = intervals[intervals.size() / 2];
  figures.frame_p95_ms = intervals[intervals.size() * 95 / 100];
}

}  // namespace

DrawingScope::DrawingScope() {
  if (drawing_depth++ == 0) drawing_since = Clock::now();
}

DrawingScope::~DrawingScope() {
  if (--drawing_depth == 0) drawn_ms += ms_since(drawing_since);
}

bool TimedApplication::notify(QObject* receiver, QEvent* event) {
  std::optional<DrawingScope> drawing;
  if (draws(event->type())) drawing.emplace();
  const auto start = Clock::now();
  const double drawn_before = drawn_ms;
  ++depth_;
  const bool result = QApplication::notify(receiver, event);
  --depth_;
  drawing.reset();
  if (depth_ == 0) longest_ms_ = std::max(longest_ms_, ms_since(start) - (drawn_ms - drawn_before));
  return result;
}

double TimedApplication::take_longest_task_ms() {
  return std::exchange(longest_ms_, 0);
}

WindowFigures measure_window(TimedApplication& application, MainWindow& window, const std::string& file,
                             double seconds) {
  WindowFigures figures;
  window.show();
  run_for(300);
  application.take_longest_task_ms();
  QElapsedTimer clock;
  clock.start();
  bool opened = false;
  window.open(QString::fromStdString(file), [&] { opened = true; });
  while (!opened && clock.elapsed() < kOpenTimeoutMs) run_for(5);
  if (!opened) throw Error("it took too long to open", {file, 0, {}});
  while (window.browser().moment().belief.time == 0) run_for(2);
  figures.open_s = static_cast<double>(clock.elapsed()) / 1000;
  settle(window);
  figures.open_task_ms = application.take_longest_task_ms();
  scrub(window, seconds, figures);
  settle(window);
  figures.scrub_task_ms = application.take_longest_task_ms();
  const auto objects = window.browser().belief().objects;
  for (int i = 0; i < kObjects && !objects.empty(); ++i) {
    window.browser().selection().select_object(
        objects[static_cast<size_t>(i) * objects.size() / kObjects].id);
    settle(window);
  }
  for (const auto* dock : window.docks()) {
    window.show_dock(dock->objectName().toStdString());
    run_for(100);
  }
  settle(window);
  finish_background();
  run_for(100);
  figures.select_task_ms = application.take_longest_task_ms();
  return figures;
}

std::string text_of(const WindowFigures& figures) {
  return fmt::format(
      "opened: first moment shown after {:.2f} s\n"
      "scrubbing: {:.1f} frames per second ({} frames), {:.0f} ms from one to the next (95 %: {:.0f} ms)\n"
      "longest task of the window's thread but drawing: opening {:.0f} ms, scrubbing {:.0f} ms, choosing "
      "objects and "
      "docks {:.0f} ms\n",
      figures.open_s, figures.frames_per_s, figures.frames, figures.frame_median_ms, figures.frame_p95_ms,
      figures.open_task_ms, figures.scrub_task_ms, figures.select_task_ms);
}

}  // namespace loci
