#include "mapping/base/user_time_zone.h"

namespace loci {

TimeZone user_time_zone(const char* tz) {
  if (tz != nullptr && *tz != '\0') {
    try {
      return TimeZone::named(*tz == ':' ? tz + 1 : tz);
    } catch (const Error&) {
      // A rule such as CET-1CEST has no name in the database.
    }
  }
  return TimeZone::of_machine();
}

}  // namespace loci
