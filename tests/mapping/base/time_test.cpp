#include "mapping/base/time.h"

#include <gtest/gtest.h>

#include <limits>

#include "mapping/base/error.h"
#include "mapping/base/time_limits.h"

namespace loci {
namespace {

TEST(Time, ReadsIsoWithZones) {
  EXPECT_EQ(parse_time("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(parse_time("2000-01-01T00:00:00Z"), 946684800 * kSecond);
  EXPECT_EQ(parse_time("2000-01-01T02:00:00+02:00"), 946684800 * kSecond);
  EXPECT_EQ(parse_time("1999-12-31T19:00:00.25-05:00"), 946684800 * kSecond + kSecond / 4);
  EXPECT_EQ(parse_time("2000-01-01"), 946684800 * kSecond);
}

TEST(Time, FormatsWhatItReads) {
  for (const char* text :
       {"2026-05-01T07:10:00Z", "1969-12-31T23:59:59.5Z", "2026-05-01T07:10:00.033333333Z"})
    EXPECT_EQ(format_time(parse_time(text)), text);
  EXPECT_EQ(format_time(parse_time("2026-05-01T07:10:00Z"), 120), "2026-05-01T09:10:00+02:00");
}

TEST(Time, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "yesterday", "2026-13-01", "2026-02-30", "2026-05-01T07:10", "2026-05-01T07:10:00"})
    EXPECT_THROW(parse_time(text), Error) << text;
}

TEST(Time, RefusesClocksAndZonesThatDoNotExist) {
  for (const char* text : {"2026-05-01T24:00:01Z", "2026-05-01T07:10:00+99:00", "2026-05-01T07:10:00+02:60",
                           "2116-01-01T00:00:00Z", "1823-12-31", "0001-01-01"})
    EXPECT_THROW(parse_time(text), Error) << text;
  EXPECT_EQ(parse_time("2026-05-01T24:00:00Z"), parse_time("2026-05-02"));
}

TEST(Time, DifferencesOfTimesThatAreReadFit) {
  const TimeNs first = parse_time("1824-01-01T00:00:00+15:59"),
               last = parse_time("2115-12-31T24:00:00-15:59");
  EXPECT_TRUE(is_within_limits(first));
  EXPECT_TRUE(is_within_limits(last));
  EXPECT_EQ(kMaxTime - -kMaxTime, std::numeric_limits<TimeNs>::max() - 1);
}

TEST(Time, FormatsWhatEverFits) {
  constexpr TimeNs kFirst = std::numeric_limits<TimeNs>::min(), kLast = std::numeric_limits<TimeNs>::max();
  EXPECT_EQ(format_time(kFirst), "1677-09-21T00:12:43.145224192Z");
  EXPECT_EQ(format_time(kLast), "2262-04-11T23:47:16.854775807Z");
  EXPECT_EQ(format_time(kLast, 14 * 60), "2262-04-12T13:47:16.854775807+14:00");
}

}  // namespace
}  // namespace loci
