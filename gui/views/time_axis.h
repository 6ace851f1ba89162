#pragma once

#include <QObject>

#include "mapping/base/time.h"

namespace loci::gui {

/// Which part of a memory's time is shown, shared by the track and the lanes below it, so that they stay in
/// line. Left of the axis is room for names.
class TimeAxis : public QObject {
  Q_OBJECT

 public:
  static constexpr double kLeft = 118;  ///< pixels of a widget left of the axis
  static constexpr double kRight = 16;

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
  /// Moves what is shown until a time is in it.
  void reveal(TimeNs time);

 Q_SIGNALS:
  void changed();

 private:
  void show(TimeNs from, TimeNs to);

  TimeNs first_ = 0, last_ = 0, from_ = 0, to_ = 0;
};

}  // namespace loci::gui
