#pragma once

#include <QWidget>

#include "gui/browser.h"
#include "gui/views/backdrop.h"
#include "gui/views/time_axis.h"

namespace loci::gui {

/// The slider of the time bar: an axis with a tick per scene, a dot per event, the observations of the chosen
/// object, and a handle at the chosen time. The wheel zooms, a drag with the right button moves along.
class TimeTrack : public QWidget {
  Q_OBJECT

 public:
  TimeTrack(Browser& browser, TimeAxis& axis, QWidget* parent = nullptr);

  /// Where a time is, in pixels from the left, and back.
  double x_of(TimeNs time) const;
  TimeNs time_at(double x) const;
  QSize sizeHint() const override { return {600, 64}; }
  QSize minimumSizeHint() const override { return {200, 64}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  bool event(QEvent* event) override;

 private:
  void refresh();
  void drag(double x);
  /// What does not depend on the chosen time.
  void paint_backdrop(QPainter& painter) const;
  void redraw();
  void paint_axis(QPainter& painter) const;
  void paint_events(QPainter& painter) const;
  void paint_handle(QPainter& painter) const;

  Browser& browser_;
  bool shows(double x) const;

  TimeAxis& axis_;
  Backdrop backdrop_;
  std::vector<TimeNs> observations_;  ///< of the chosen object
  double dragged_from_ = 0;
};

}  // namespace loci::gui
