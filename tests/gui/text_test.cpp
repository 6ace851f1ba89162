#include "gui/core/text.h"

#include <gtest/gtest.h>

namespace loci::gui {
namespace {

TEST(TimeText, IsInTheZoneOfTheMemory) {
  const TimeNs time = parse_time("2026-05-01T07:10:00.5Z");
  EXPECT_EQ(time_text(time, TimeZone::fixed(120)), "2026-05-01 09:10:00.5");
  EXPECT_EQ(time_text(time, TimeZone::fixed(0)), "2026-05-01 07:10:00.5");
  EXPECT_EQ(time_text(time, TimeZone::fixed(-330)), "2026-05-01 01:40:00.5");
}

TEST(TimeText, NamesTheZoneAndItsOffset) {
  const TimeNs summer = parse_time("2026-07-01T07:10:00Z"), winter = parse_time("2026-01-01T07:10:00Z");
  EXPECT_EQ(zone_text(summer, TimeZone()), "UTC");
  EXPECT_EQ(zone_text(summer, TimeZone::fixed(-330)), "UTC−05:30");
  EXPECT_EQ(zone_text(summer, TimeZone::named("Europe/Berlin")), "Europe/Berlin, UTC+02:00");
  EXPECT_EQ(zone_text(winter, TimeZone::named("Europe/Berlin")), "Europe/Berlin, UTC+01:00");
}

TEST(DurationText, UsesTheUnitThatFits) {
  EXPECT_EQ(duration_text(0, 12 * kSecond), "12 s");
  EXPECT_EQ(duration_text(0, 180 * kSecond), "3 min");
  EXPECT_EQ(duration_text(0, 2 * 3600 * kSecond + 300 * kSecond), "2 h 5 min");
  EXPECT_EQ(duration_text(0, 28 * kHour + kMinute), "28 h");
}

TEST(ApartText, SaysWhichSceneIsShownInstead) {
  EXPECT_EQ(apart_text(kHour, kHour + 59 * kSecond), "") << "so long a scene stands for its time";
  EXPECT_EQ(apart_text(kHour, 3 * kHour), "2 h 0 min before");
  EXPECT_EQ(apart_text(kHour, kHour - 90 * kSecond), "1 min later");
}

TEST(PercentText, KeepsCertaintyForWhatIsCertain) {
  EXPECT_EQ(percent_text(1), "100 %");
  EXPECT_EQ(percent_text(0.999), "> 99 %");
  EXPECT_EQ(percent_text(0.001), "< 1 %");
  EXPECT_EQ(percent_text(0.42), "42 %");
}

}  // namespace
}  // namespace loci::gui
