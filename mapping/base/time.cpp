#include "mapping/base/time.h"

#include <fmt/format.h>

#include <chrono>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"

namespace loci {
namespace {

/// Reads digits of an ISO 8601 text from left to right.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  int64_t number(size_t digits) {
    int64_t value = 0;
    for (size_t i = 0; i < digits; ++i) {
      if (at_ >= text_.size() || !is_digit(text_[at_])) fail();
      value = 10 * value + (text_[at_++] - '0');
    }
    return value;
  }
  bool accept(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail();
  }
  int64_t fraction_ns() {
    int64_t value = 0, scale = kSecond / 10;
    if (at_ >= text_.size() || !is_digit(text_[at_])) fail();
    for (; at_ < text_.size() && is_digit(text_[at_]); ++at_, scale /= 10)
      value += scale * (text_[at_] - '0');
    return value;
  }
  bool at_end() const { return at_ == text_.size(); }
  [[noreturn]] void fail() const {
    throw Error(fmt::format("'{}' is not a time", text_), {},
                "write it as 2026-05-01T07:10:00Z (or with a zone such as +02:00)");
  }

 private:
  std::string_view text_;
  size_t at_ = 0;
};

}  // namespace

TimeNs parse_time(std::string_view text) {
  using namespace std::chrono;
  Cursor cursor(text);
  const auto y = static_cast<int>(cursor.number(4));
  cursor.expect('-');
  const auto m = static_cast<unsigned>(cursor.number(2));
  cursor.expect('-');
  const auto d = static_cast<unsigned>(cursor.number(2));
  const year_month_day date{year(y), month(m), day(d)};
  if (!date.ok() || y < 1824 || y > 2115) cursor.fail();  // Within kMaxTime, in all zones.
  int64_t seconds = sys_days(date).time_since_epoch().count() * int64_t{86400};
  if (cursor.at_end()) return seconds * kSecond;
  if (!cursor.accept('T')) cursor.expect(' ');
  const int64_t hour = cursor.number(2);
  cursor.expect(':');
  const int64_t minute = cursor.number(2);
  const int64_t second = cursor.accept(':') ? cursor.number(2) : 0;
  if (hour > 24 || minute > 59 || second > 60 || (hour == 24 && minute + second > 0)) cursor.fail();
  const int64_t nanoseconds = cursor.accept('.') ? cursor.fraction_ns() : 0;
  seconds += 3600 * hour + 60 * minute + second;
  if (!cursor.accept('Z')) {
    const int64_t sign = cursor.accept('-') ? -1 : 1;
    if (sign > 0) cursor.expect('+');
    const int64_t zone_hour = cursor.number(2);
    cursor.accept(':');
    const int64_t zone_minute = cursor.number(2);
    if (zone_hour > 15 || zone_minute > 59) cursor.fail();
    seconds -= sign * (3600 * zone_hour + 60 * zone_minute);
  }
  if (!cursor.at_end()) cursor.fail();
  return seconds * kSecond + nanoseconds;
}

std::string format_time(TimeNs time) {
  std::string text = format_time(time, 0);
  text.replace(text.size() - 6, 6, "Z");
  return text;
}

std::string format_time(TimeNs time, int zone_minutes) {
  using namespace std::chrono;
  // In seconds: the zone, or the midnight before, may lie outside what nanoseconds can hold.
  const auto whole = floor<seconds>(nanoseconds(time));
  const sys_seconds point{whole + minutes(zone_minutes)};
  const auto midnight = floor<days>(point);
  const year_month_day date(midnight);
  const hh_mm_ss clock(point - midnight);
  std::string text = fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", static_cast<int>(date.year()),
                                 static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                                 clock.hours().count(), clock.minutes().count(), clock.seconds().count());
  const TimeNs past_second = time % kSecond;
  if (const TimeNs fraction = past_second < 0 ? past_second + kSecond : past_second; fraction != 0) {
    text += fmt::format(".{:09}", fraction);
    text.erase(text.find_last_not_of('0') + 1);
  }
  const int absolute = zone_minutes < 0 ? -zone_minutes : zone_minutes;
  return text + fmt::format("{}{:02}:{:02}", zone_minutes < 0 ? '-' : '+', absolute / 60, absolute % 60);
}

TimeNs now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace loci
