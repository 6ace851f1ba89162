#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace loci {

/// Nanoseconds since the Unix epoch, UTC.
using TimeNs = int64_t;

inline constexpr TimeNs kSecond = 1'000'000'000;
inline constexpr TimeNs kMinute = 60 * kSecond;
inline constexpr TimeNs kHour = 60 * kMinute;
inline constexpr TimeNs kDay = 24 * kHour;

/// A difference of times in seconds.
constexpr double in_seconds(TimeNs span) {
  return static_cast<double>(span) / static_cast<double>(kSecond);
}

/// ISO 8601 with zone ("2026-05-01T07:10:00Z", "…T09:10:00.5+02:00"; a date alone is its midnight UTC).
/// Throws Error naming the text when it is not one.
TimeNs parse_time(std::string_view text);

/// ISO 8601 in UTC with as many decimals as needed: "2026-05-01T07:10:00Z", "2026-05-01T07:10:00.033333333Z".
std::string format_time(TimeNs time);

/// ISO 8601 in a zone given as minutes east of UTC: "2026-05-01T09:10:00+02:00".
std::string format_time(TimeNs time, int zone_minutes);

/// The machine's clock.
TimeNs now();

}  // namespace loci
