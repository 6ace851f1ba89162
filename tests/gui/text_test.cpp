#include "gui/core/text.h"

#include <gtest/gtest.h>

namespace loci::gui {
namespace {

TEST(TimeText, IsInTheZoneOfTheMemory) {
  const TimeNs time = parse_time("2026-05-01T07:10:00.5Z");
  EXPECT_EQ(time_text(time, 120), "2026-05-01 09:10:00.5");
  EXPECT_EQ(time_text(time, 0), "2026-05-01 07:10:00.5");
  EXPECT_EQ(time_text(time, -330), "2026-05-01 01:40:00.5");
}

TEST(DurationText, UsesTheUnitThatFits) {
  EXPECT_EQ(duration_text(0, 12 * kSecond), "12 s");
  EXPECT_EQ(duration_text(0, 180 * kSecond), "3 min");
  EXPECT_EQ(duration_text(0, 2 * 3600 * kSecond + 300 * kSecond), "2 h 5 min");
}

TEST(PercentText, KeepsCertaintyForWhatIsCertain) {
  EXPECT_EQ(percent_text(1), "100 %");
  EXPECT_EQ(percent_text(0.999), "> 99 %");
  EXPECT_EQ(percent_text(0.001), "< 1 %");
  EXPECT_EQ(percent_text(0.42), "42 %");
}

}  // namespace
}  // namespace loci::gui
