#pragma once

#include <QObject>
#include <optional>
#include <string>

#include "mapping/base/time.h"

namespace loci::gui {

/// The selection of all views: an object or a place (never both), and a time.
class SelectionModel : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  std::optional<int64_t> object() const { return object_; }
  const std::string& place() const { return place_; }  ///< empty = none
  TimeNs time() const { return time_; }
  /// Transaction time: as it was known then; unset = as known now.
  std::optional<TimeNs> known_at() const { return known_at_; }

  void select_object(std::optional<int64_t> object);
  void select_place(const std::string& place);
  void set_time(TimeNs time);
  void set_known_at(std::optional<TimeNs> known_at);
  /// No object and no place; the time stays.
  void clear();

 Q_SIGNALS:
  /// Object or place.
  void selected();
  void time_changed();  ///< valid time or transaction time

 private:
  std::optional<int64_t> object_;
  std::string place_;
  TimeNs time_ = 0;
  std::optional<TimeNs> known_at_;
};

}  // namespace loci::gui
