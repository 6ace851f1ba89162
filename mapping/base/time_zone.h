#pragma once

#include <string>

#include "mapping/base/error.h"
#include "mapping/base/time.h"

namespace date {
class time_zone;
}

namespace loci {

/// What clocks on the wall show, and when they are set forward or back.
class TimeZone {
 public:
  TimeZone() = default;  ///< UTC
  /// The same all year.
  static TimeZone fixed(int minutes_east);
  /// "Europe/Berlin" as in the IANA time zone database of this machine, "UTC", or "+02:00". Error otherwise,
  /// with the place where it is written.
  static TimeZone named(const std::string& name, const FileLocation& where = {});
  /// The machine's; UTC where it has none.
  static TimeZone of_machine();

  /// As named() takes it.
  std::string name() const;
  /// East of UTC.
  int minutes_at(TimeNs time) const;
  /// What clocks show, as nanoseconds since they showed the epoch's midnight.
  TimeNs local(TimeNs time) const;
  /// The moment at which clocks show a time: where they are set back they show it twice, and what they skip
  /// is the moment at which they are set forward.
  TimeNs first_moment(TimeNs local) const;
  TimeNs last_moment(TimeNs local) const;

  /// "2026-05-01T09:10:00+02:00".
  std::string format(TimeNs time) const { return format_time(time, minutes_at(time)); }

 private:
  const date::time_zone* zone_ = nullptr;  ///< of the database, which is never unloaded
  int minutes_ = 0;                        ///< without a zone of the database
};

}  // namespace loci
