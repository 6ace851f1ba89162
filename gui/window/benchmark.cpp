#include "gui/window/benchmark.h"

#include <fmt/format.h>

#include <QDockWidget>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QTimer>
#include <algorithm>
#include <vector>

#include "gui/core/background.h"
#include "gui/window/main_window.h"
#include "mapping/base/error.h"
#include "mapping/base/stopwatch.h"

namespace loci::gui {
namespace {

constexpr int kMouseMs = 8;
constexpr int kObjects = 10;
constexpr int kOpenTimeoutMs = 120000;

void run_for(double ms) {
  QEventLoop loop;
  QTimer::singleShot(static_cast<int>(ms), &loop, &QEventLoop::quit);
  loop.exec();
}

/// Until nothing is read any more.
void settle(MainWindow& window) {
  do run_for(30);
  while (window.browser().reader().waiting() > 0 || window.files().loader().is_loading());
}

void scrub(MainWindow& window, double seconds, WindowFigures& figures) {
  const auto& scenes = window.browser().data()->scenes();
  if (scenes.size() < 2) return;
  std::vector<double> intervals;
  QElapsedTimer clock, since_frame;
  TimeNs shown = 0;
  const auto connection = QObject::connect(&window.map(), &MapView::drawn, &window, [&] {
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
  const Stopwatch watch;
  clock.start();
  since_frame.start();
  mouse.start(kMouseMs);
  run_for(seconds * 1000);
  mouse.stop();
  QObject::disconnect(connection);
  if (intervals.empty()) return;
  figures.frames = intervals.size();
  figures.frame_cpu_ms = 1000 * watch.cpu_seconds() / static_cast<double>(intervals.size());
  figures.frames_per_s = static_cast<double>(intervals.size()) / seconds;
  std::sort(intervals.begin(), intervals.end());
  figures.frame_median_ms = intervals[intervals.size() / 2];
  figures.frame_p95_ms = intervals[intervals.size() * 95 / 100];
}

void open(MainWindow& window, const std::string& file, WindowFigures& figures) {
  QElapsedTimer clock;
  clock.start();
  bool opened = false;
  window.open(QString::fromStdString(file), [&] { opened = true; });
  while (!opened && clock.elapsed() < kOpenTimeoutMs) run_for(5);
  if (!opened) throw Error("it took too long to open", {file, 0, {}});
  while (window.browser().moment().belief.time == 0) run_for(2);
  figures.open_s = static_cast<double>(clock.elapsed()) / 1000;
  settle(window);
}

void select_objects(MainWindow& window) {
  const auto objects = window.browser().belief().objects;
  for (int i = 0; i < kObjects && !objects.empty(); ++i) {
    window.browser().selection().select_object(
        objects[static_cast<size_t>(i) * objects.size() / kObjects].object);
    settle(window);
  }
}

void show_docks(MainWindow& window) {
  for (const auto* dock : window.docks().all()) {
    window.docks().show(dock->objectName().toStdString());
    run_for(100);
  }
  settle(window);
  finish_background();
  run_for(100);
}

}  // namespace

WindowFigures benchmark_window(TimedApplication& application, MainWindow& window, const std::string& file,
                               double seconds) {
  WindowFigures figures;
  window.show();
  run_for(300);
  application.take_longest_task();
  open(window, file, figures);
  figures.open_task = application.take_longest_task();
  scrub(window, seconds, figures);
  settle(window);
  figures.scrub_task = application.take_longest_task();
  select_objects(window);
  show_docks(window);
  figures.select_task = application.take_longest_task();
  return figures;
}

std::string to_text(const WindowFigures& figures) {
  const auto task = [](const LongestTask& longest) {
    return fmt::format("{:.0f} ms, {:.0f} of them computing ({})", longest.ms, longest.cpu_ms, longest.what);
  };
  return fmt::format(
      "opened: first moment shown after {:.2f} s\n"
      "scrubbing: {:.1f} frames per second ({} frames), {:.0f} ms from one to the next (95 %: {:.0f} ms), "
      "{:.0f} ms of CPU time each\n"
      "longest task of the window's thread but drawing: opening {}, scrubbing {}, selecting objects and "
      "docks {}\n",
      figures.open_s, figures.frames_per_s, figures.frames, figures.frame_median_ms, figures.frame_p95_ms,
      figures.frame_cpu_ms, task(figures.open_task), task(figures.scrub_task), task(figures.select_task));
}

}  // namespace loci::gui
