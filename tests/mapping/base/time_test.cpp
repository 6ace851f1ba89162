#include "mapping/base/time.h"

#include <gtest/gtest.h>

#include "mapping/base/error.h"

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

}  // namespace
}  // namespace loci
