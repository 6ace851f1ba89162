#include "gui/core/task_timer.h"

#include <fmt/format.h>

#include <QEvent>
#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "mapping/base/stopwatch.h"

namespace loci::gui {
namespace {

using Clock = std::chrono::steady_clock;

int drawing_depth = 0;
Clock::time_point drawing_since;
double drawn_ms = 0;
std::string task_name;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool draws(QEvent::Type type) {
  return type == QEvent::Paint || type == QEvent::UpdateRequest || type == QEvent::Expose ||
         type == QEvent::UpdateLater;
}

}  // namespace

DrawingScope::DrawingScope() {
  if (drawing_depth++ == 0) drawing_since = Clock::now();
}

DrawingScope::~DrawingScope() {
  if (--drawing_depth == 0) drawn_ms += ms_since(drawing_since);
}

void name_task(const std::string& what) {
  task_name = what;
}

bool TimedApplication::notify(QObject* receiver, QEvent* event) {
  std::optional<DrawingScope> drawing;
  if (draws(event->type())) drawing.emplace();
  const auto start = Clock::now();
  const double drawn_before = drawn_ms, cpu_before = 1000 * thread_cpu_seconds();
  // The receiver may be gone afterwards.
  const char* receiver_class = receiver->metaObject()->className();
  const QEvent::Type type = event->type();
  if (depth_++ == 0) task_name.clear();
  const bool result = QApplication::notify(receiver, event);
  drawing.reset();
  if (--depth_ > 0) return result;
  const double ms = ms_since(start) - (drawn_ms - drawn_before);
  if (ms > longest_.ms)
    longest_ = {
        ms, std::min(ms, 1000 * thread_cpu_seconds() - cpu_before),
        task_name.empty() ? fmt::format("{}, event {}", receiver_class, static_cast<int>(type)) : task_name};
  return result;
}

LongestTask TimedApplication::take_longest_task() {
  return std::exchange(longest_, {});
}

}  // namespace loci::gui
