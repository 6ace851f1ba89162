#include "mapping/base/time_zone.h"

#include <date/tz.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <stdexcept>

namespace loci {
namespace {

// Zones are at most 15 hours away; their times stay in what 64 bits hold.
constexpr TimeNs kMargin = 24 * (60 * kMinute);
constexpr TimeNs kFirst = std::numeric_limits<TimeNs>::min() + kMargin;
constexpr TimeNs kLast = std::numeric_limits<TimeNs>::max() - kMargin;

TimeNs within_limits(TimeNs time) {
  return std::clamp(time, kFirst, kLast);
}

std::chrono::seconds whole_seconds(TimeNs time) {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::nanoseconds(time));
}

TimeNs offset(const date::sys_info& info) {
  return info.offset.count() * kSecond;
}

/// The zone "+02:00" or "-0330".
std::optional<int> fixed_minutes(const std::string& name) {
  if (name == "UTC" || name == "Z") return 0;
  if (name.empty() || (name[0] != '+' && name[0] != '-')) return {};
  try {
    return static_cast<int>(-parse_time("2000-01-01T00:00:00" + name) / kMinute +
                            parse_time("2000-01-01T00:00:00Z") / kMinute);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

TimeZone TimeZone::fixed(int minutes_east) {
  TimeZone zone;
  zone.minutes_ = minutes_east;
  return zone;
}

TimeZone TimeZone::named(const std::string& name, const FileLocation& where) {
  if (const auto minutes = fixed_minutes(name)) return fixed(*minutes);
  TimeZone zone;
  try {
    zone.zone_ = date::locate_zone(name);
  } catch (const std::runtime_error&) {
    throw Error(fmt::format("the time zone '{}' is not known here", name), where,
                "write Europe/Berlin, UTC or +02:00; names are those of the package tzdata");
  }
  return zone;
}

TimeZone TimeZone::of_machine() {
  TimeZone zone;
  try {
    zone.zone_ = date::current_zone();
  } catch (const std::runtime_error&) {
    return {};
  }
  return zone.name() == "Etc/UTC" ? TimeZone() : zone;
}

std::string TimeZone::name() const {
  if (zone_ != nullptr) return zone_->name();
  if (minutes_ == 0) return "UTC";
  return format_time(0, minutes_).substr(19);
}

int TimeZone::minutes_at(TimeNs time) const {
  return static_cast<int>((local(time) - within_limits(time)) / kMinute);
}

TimeNs TimeZone::local(TimeNs time) const {
  time = within_limits(time);
  if (zone_ == nullptr) return time + minutes_ * kMinute;
  return time + offset(zone_->get_info(date::sys_seconds(whole_seconds(time))));
}

TimeNs TimeZone::first_moment(TimeNs local) const {
  local = within_limits(local);
  if (zone_ == nullptr) return local - minutes_ * kMinute;
  const date::local_info info = zone_->get_info(date::local_seconds(whole_seconds(local)));
  if (info.result != date::local_info::nonexistent) return local - offset(info.first);
  return std::chrono::nanoseconds(info.first.end.time_since_epoch()).count();
}

TimeNs TimeZone::last_moment(TimeNs local) const {
  local = within_limits(local);
  if (zone_ == nullptr) return first_moment(local);
  const date::local_info info = zone_->get_info(date::local_seconds(whole_seconds(local)));
  return info.result == date::local_info::ambiguous ? local - offset(info.second) : first_moment(local);
}

}  // namespace loci
