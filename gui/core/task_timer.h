#pragma once

#include <QApplication>
#include <string>

namespace loci::gui {

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
  double ms = 0;          ///< wall time
  double cpu_ms = 0;      ///< of it, CPU time of the thread
  std::string what = {};  ///< the last name given by name_task(), else the receiver's class and its event
};

/// Names what the thread of the windows is doing.
void name_task(const std::string& what);

/// An application that measures the longest task of its thread, drawing left out.
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

}  // namespace loci::gui
