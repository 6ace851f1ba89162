#pragma once

#include <QObject>
#include <QWidget>

#include "gui/core/widgets.h"
#include "gui/data/browser.h"
#include "mapping/base/time.h"

namespace loci::gui {

/// Which part of a memory's time is shown, shared by the track and the lanes below it, so that they stay in
/// line. Left of the axis is room for names.
class TimeAxis : public QObject {
  Q_OBJECT

 public:
  static constexpr double kLeft = 118;  ///< pixels of a widget left of the axis
  static constexpr double kRight = 16;
  static constexpr double kZoomStep = 1.25;  ///< of a turn of the wheel
  static constexpr double kSnap = 5;         ///< pixels within which a drag takes the time of a scene

  using QObject::QObject;

  /// The whole of the memory; shows all of it.
  void set_whole(TimeNs first, TimeNs last);
  /// The memory has grown: what is shown stays, unless it was all.
  void grow(TimeNs first, TimeNs last);
  TimeNs first() const { return first_; }
  TimeNs last() const { return last_; }
  /// What is shown.
  TimeNs from() const { return from_; }
  TimeNs to() const { return to_; }

  /// Where a time is in a widget of this width, in pixels from its left, and back.
  double x_of(TimeNs time, int width) const;
  TimeNs time_at(double x, int width) const;

  /// A factor below 1 shows less; `at` stays where it is.
  void zoom(double factor, TimeNs at);
  void show_all() { show(first_, last_); }
  /// Moves what is shown by a part of it.
  void pan(double part);
  /// Moves what is shown until a time is in it; the axis grows for one before or after all scenes.
  void reveal(TimeNs time);

 Q_SIGNALS:
  void changed();

 private:
  void show(TimeNs from, TimeNs to);

  TimeNs first_ = 0, last_ = 0, from_ = 0, to_ = 0;
};

/// The scene's time when a drag comes near to it, else the time at this place.
TimeNs snapped_time(const OpenMemory& memory, const TimeAxis& axis, double x, int width);

/// The slider of the time bar: an axis with a tick per scene, a dot per event, the observations of the chosen
/// object, and a handle at the selected time. The wheel zooms, a drag with the right button moves along.
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
  /// What does not depend on the selected time.
  void paint_backdrop(QPainter& painter) const;
  void redraw();
  void paint_axis(QPainter& painter) const;
  void paint_events(QPainter& painter) const;
  void paint_handle(QPainter& painter) const;

  Browser& browser_;
  bool shows(double x) const;

  TimeAxis& axis_;
  Backdrop backdrop_;
  std::vector<TimeNs> observations_;  ///< of the selected object
  double dragged_from_ = 0;
};

}  // namespace loci::gui
