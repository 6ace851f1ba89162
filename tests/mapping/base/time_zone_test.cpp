#include "mapping/base/time_zone.h"

#include <gtest/gtest.h>

#include <limits>

#include "mapping/base/error.h"

namespace loci {
namespace {

TEST(TimeZones, HaveNamesOrOffsets) {
  EXPECT_EQ(TimeZone().name(), "UTC");
  EXPECT_EQ(TimeZone::named("UTC").name(), "UTC");
  EXPECT_EQ(TimeZone::named("+02:00").name(), "+02:00");
  EXPECT_EQ(TimeZone::named("-0330").name(), "-03:30");
  EXPECT_EQ(TimeZone::named("Asia/Kathmandu").name(), "Asia/Kathmandu");
  EXPECT_EQ(TimeZone::named("Asia/Kathmandu").minutes_at(parse_time("2026-05-01T00:00:00Z")), 345);
  EXPECT_EQ(TimeZone::named(TimeZone::of_machine().name()).name(), TimeZone::of_machine().name());
  for (const char* wrong :
       {"", "Berlin", "Europe/berlin", "+25:00", "../../etc/passwd", "/etc/localtime", "+", "CET-1CEST"})
    EXPECT_THROW(TimeZone::named(wrong), Error) << wrong;
}

TEST(TimeZones, FollowTheYear) {
  const TimeZone berlin = TimeZone::named("Europe/Berlin");
  EXPECT_EQ(berlin.minutes_at(parse_time("2026-07-01T00:00:00Z")), 120);
  EXPECT_EQ(berlin.minutes_at(parse_time("2026-12-01T00:00:00Z")), 60);
  EXPECT_EQ(berlin.format(parse_time("2026-07-01T07:10:00.5Z")), "2026-07-01T09:10:00.5+02:00");
}

TEST(TimeZones, FindTheMomentsOfAClockTime) {
  const TimeZone berlin = TimeZone::named("Europe/Berlin");
  const auto local = [](const char* text) { return parse_time(text); };
  // Shown twice, once, never.
  EXPECT_EQ(format_time(berlin.first_moment(local("2026-10-25T02:30:00Z"))), "2026-10-25T00:30:00Z");
  EXPECT_EQ(format_time(berlin.last_moment(local("2026-10-25T02:30:00Z"))), "2026-10-25T01:30:00Z");
  EXPECT_EQ(format_time(berlin.first_moment(local("2026-06-01T02:30:00Z"))), "2026-06-01T00:30:00Z");
  EXPECT_EQ(format_time(berlin.last_moment(local("2026-03-29T02:30:00Z"))), "2026-03-29T01:00:00Z");
  // There and back wherever clocks are not changed, also outside of what 64 bits can add.
  for (const TimeNs time :
       {parse_time("2026-05-01T07:10:00Z"), parse_time("1969-12-31T23:59:59Z"), TimeNs{-1}})
    EXPECT_EQ(berlin.first_moment(berlin.local(time)), time);
  for (const TimeNs limit : {std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max()})
    EXPECT_NE(berlin.local(limit), berlin.first_moment(limit));
}

}  // namespace
}  // namespace loci
