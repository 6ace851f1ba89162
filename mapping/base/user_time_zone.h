#pragma once

#include "mapping/base/time_zone.h"

namespace loci {

/// The one that the environment variable TZ names, given its value or nullptr; otherwise the machine's.
TimeZone user_time_zone(const char* tz);

}  // namespace loci
