#include "memory/questions/time_parser.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "mapping/base/error.h"

namespace loci::memory {
namespace {

/// The last scene is at 10:30 in a zone two hours east of UTC.
const TimeReader kReader(parse_time("2026-05-01T08:30:00Z"), TimeZone::fixed(120));

void expect_span(const char* text, const char* first, const char* last) {
  const TimeSpan span = kReader.read(text);
  EXPECT_EQ(format_time(span.first), first) << text;
  EXPECT_EQ(format_time(span.last), last) << text;
}

TEST(PeopleTime, ReadsWhatPeopleSayInTheMemorysZone) {
  expect_span("09:00", "2026-05-01T07:00:00Z", "2026-05-01T07:00:59.999999999Z");
  expect_span("9:00", "2026-05-01T07:00:00Z", "2026-05-01T07:00:59.999999999Z");
  expect_span("09:00:05", "2026-05-01T07:00:05Z", "2026-05-01T07:00:05.999999999Z");
  expect_span("yesterday 9:00", "2026-04-30T07:00:00Z", "2026-04-30T07:00:59.999999999Z");
  expect_span("yesterday", "2026-04-29T22:00:00Z", "2026-04-30T21:59:59.999999999Z");
  expect_span("today", "2026-04-30T22:00:00Z", "2026-05-01T21:59:59.999999999Z");
  expect_span("2026-05-01", "2026-04-30T22:00:00Z", "2026-05-01T21:59:59.999999999Z");
  expect_span("2026-05-01 09:00", "2026-05-01T07:00:00Z", "2026-05-01T07:00:59.999999999Z");
  expect_span("2026-05-01T09:00", "2026-05-01T07:00:00Z", "2026-05-01T07:00:59.999999999Z");
  expect_span("2026-05-01T09:00:00Z", "2026-05-01T09:00:00Z", "2026-05-01T09:00:00Z");
  expect_span("2026-05-01T09:00:00+02:00", "2026-05-01T07:00:00Z", "2026-05-01T07:00:00Z");
  expect_span("2026-05-01 09:00:00.25", "2026-05-01T07:00:00.25Z", "2026-05-01T07:00:00.25Z");
  expect_span("20 minutes ago", "2026-05-01T08:10:00Z", "2026-05-01T08:10:00Z");
  expect_span("2 days ago", "2026-04-29T08:30:00Z", "2026-04-29T08:30:00Z");
  expect_span("now", "2026-05-01T08:30:00Z", "2026-05-01T08:30:00Z");
}

TEST(PeopleTime, ReadsTimesInWords) {
  // The last scene was on a Friday, at 10:30 local time.
  expect_span("this morning", "2026-05-01T03:00:00Z", "2026-05-01T09:59:59.999999999Z");
  expect_span("yesterday evening", "2026-04-30T16:00:00Z", "2026-04-30T21:59:59.999999999Z");
  expect_span("last night", "2026-04-30T18:00:00Z", "2026-05-01T03:59:59.999999999Z");
  expect_span("last Monday", "2026-04-26T22:00:00Z", "2026-04-27T21:59:59.999999999Z");
  expect_span("on Friday", "2026-04-30T22:00:00Z", "2026-05-01T21:59:59.999999999Z");
  expect_span("last Friday", "2026-04-23T22:00:00Z", "2026-04-24T21:59:59.999999999Z");
  expect_span("last Monday at nine", "2026-04-27T07:00:00Z", "2026-04-27T07:00:59.999999999Z");
  expect_span("yesterday at noon", "2026-04-30T10:00:00Z", "2026-04-30T10:00:59.999999999Z");
  expect_span("at 9:00", "2026-05-01T07:00:00Z", "2026-05-01T07:00:59.999999999Z");
  expect_span("nine o'clock", "2026-05-01T07:00:00Z", "2026-05-01T07:00:59.999999999Z");
  expect_span("half past nine", "2026-05-01T07:30:00Z", "2026-05-01T07:30:59.999999999Z");
  expect_span("quarter to ten", "2026-05-01T07:45:00Z", "2026-05-01T07:45:59.999999999Z");
  expect_span("twenty-five past nine", "2026-05-01T07:25:00Z", "2026-05-01T07:25:59.999999999Z");
  expect_span("nine thirty five", "2026-05-01T07:35:00Z", "2026-05-01T07:35:59.999999999Z");
  expect_span("9pm", "2026-05-01T19:00:00Z", "2026-05-01T19:00:59.999999999Z");
  expect_span("nine in the evening", "2026-05-01T19:00:00Z", "2026-05-01T19:00:59.999999999Z");
  expect_span("the day before yesterday", "2026-04-28T22:00:00Z", "2026-04-29T21:59:59.999999999Z");
  expect_span("this week", "2026-04-26T22:00:00Z", "2026-05-03T21:59:59.999999999Z");
  expect_span("two hours ago", "2026-05-01T06:30:00Z", "2026-05-01T06:30:00Z");
  expect_span("forty-five minutes ago", "2026-05-01T07:45:00Z", "2026-05-01T07:45:00Z");
  expect_span("half an hour ago", "2026-05-01T08:00:00Z", "2026-05-01T08:00:00Z");
}

TEST(PeopleTime, ReadsDates) {
  expect_span("29 April", "2026-04-28T22:00:00Z", "2026-04-29T21:59:59.999999999Z");
  expect_span("on April 29th at nine", "2026-04-29T07:00:00Z", "2026-04-29T07:00:59.999999999Z");
  expect_span("the 29th of april", "2026-04-28T22:00:00Z", "2026-04-29T21:59:59.999999999Z");
  expect_span("3 Dec 2024", "2024-12-02T22:00:00Z", "2024-12-03T21:59:59.999999999Z");
  expect_span("2 May", "2025-05-01T22:00:00Z", "2025-05-02T21:59:59.999999999Z");  // tomorrow, or last year's
  EXPECT_FALSE(kReader.try_read("31 June"));
  EXPECT_FALSE(kReader.try_read("42 May"));
}

TEST(PeopleTime, AnHourBeforeTheMemoryBeganIsInTheAfternoon) {
  const TimeReader reader(parse_time("2026-05-01T20:30:00Z"), TimeZone::fixed(0),
                          parse_time("2026-05-01T07:10:00Z"));
  const auto first = [&](const char* text) { return format_time(reader.read(text).first).substr(11, 5); };
  EXPECT_EQ(first("quarter past three"), "15:15");
  EXPECT_EQ(first("three"), "15:00");
  EXPECT_EQ(first("nine"), "09:00");      // the memory has it
  EXPECT_EQ(first("three am"), "03:00");  // said so
  EXPECT_EQ(first("03:00"), "03:00");     // written so
  EXPECT_EQ(first("half past six"), "18:30");
  EXPECT_EQ(first("seven"), "07:00");  // ten minutes before the first look
  EXPECT_TRUE(reader.may_be_other_half("eight"));
  EXPECT_FALSE(reader.may_be_other_half("ten")) << "the memory ends before ten in the evening";
  EXPECT_FALSE(reader.may_be_other_half("08:00"));
}

TEST(PeopleTime, RefusesTheRest) {
  for (const char* text : {"", " ", "soon", "25:00", "9:60", "yesterday at teatime", "morning Monday",
                           "2026-13-01", "ago", "x days ago", "12:3a"})
    EXPECT_THROW(kReader.read(text), Error) << text;
}

TEST(PeopleTime, WritesTheDateOnlyWhenThereAreSeveral) {
  const TimeNs time = parse_time("2026-05-01T08:30:00Z");
  EXPECT_EQ(TimeWriter(TimeZone::fixed(120), false, 0, false).text(time), "10:30");
  EXPECT_EQ(TimeWriter(TimeZone::fixed(0), true, 0, true).text(time), "2026-05-01 08:30:00");
  EXPECT_EQ(TimeWriter(TimeZone::fixed(0), false, 2, true).text(time + kSecond / 3), "08:30:00.33");
  EXPECT_EQ(TimeWriter(TimeZone::fixed(0), false, 0, false).span_text(time, time + 60 * kSecond),
            "from 08:30 to 08:31");
}

TEST(PeopleTime, TwelveIsWhereTheHalfOfTheDayBegins) {
  expect_span("12:30 am", "2026-04-30T22:30:00Z", "2026-04-30T22:30:59.999999999Z");
  expect_span("12:30 pm", "2026-05-01T10:30:00Z", "2026-05-01T10:30:59.999999999Z");
  expect_span("12 am", "2026-04-30T22:00:00Z", "2026-04-30T22:00:59.999999999Z");
  expect_span("12pm", "2026-05-01T10:00:00Z", "2026-05-01T10:00:59.999999999Z");
  expect_span("8:30am", "2026-05-01T06:30:00Z", "2026-05-01T06:30:59.999999999Z");
  expect_span("yesterday 8:30pm", "2026-04-30T18:30:00Z", "2026-04-30T18:30:59.999999999Z");
  expect_span("two in the night", "2026-05-01T00:00:00Z", "2026-05-01T00:00:59.999999999Z");
  for (const char* text : {"13:30 pm", "14am", "24:30", "24:00:01", "0x8am"})
    EXPECT_FALSE(kReader.try_read(text)) << text;
}

TEST(PeopleTime, WhatDoesNotFitIsRefused) {
  for (const char* text : {"100000 weeks ago", "2147483647 weeks ago", "99999999999 days ago",
                           "2000000 days ago", "9999-12-31", "0000-00-00", "1677-01-01"})
    EXPECT_FALSE(kReader.try_read(text)) << text;
  expect_span("10000 weeks ago", "1834-09-05T08:30:00Z", "1834-09-05T08:30:00Z");
  for (const TimeNs last : {std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max()})
    for (const char* text : {"now", "yesterday", "last week", "12:30 am", "300 days ago", "last night"})
      TimeReader(last, TimeZone::fixed(14 * 60)).try_read(text);  // no overflow, which a sanitizer sees
}

/// What a memory whose last scene is at `now` in a zone makes of a time: "FIRST LAST", UTC.
std::string span_of(const char* now, const TimeZone& zone, const char* text) {
  const TimeSpan span = TimeReader(parse_time(now), zone).read(text);
  return format_time(span.first) + " " + format_time(span.last);
}

/// Central Europe, 2026: clocks are set forward on 29 March and back on 25 October, both at 01:00 UTC.
TEST(PeopleTime, FollowsClocksThatAreSetForwardOrBack) {
  const TimeZone berlin = TimeZone::named("Europe/Berlin");
  const char* after_back = "2026-10-25T12:00:00Z";
  EXPECT_EQ(span_of(after_back, berlin, "02:30"), "2026-10-25T00:30:00Z 2026-10-25T01:30:59.999999999Z")
      << "clocks show it twice: from the first to the second";
  EXPECT_EQ(span_of(after_back, berlin, "today"), "2026-10-24T22:00:00Z 2026-10-25T22:59:59.999999999Z")
      << "a day of 25 hours";
  EXPECT_EQ(span_of(after_back, berlin, "yesterday 9:00"),
            "2026-10-24T07:00:00Z 2026-10-24T07:00:59.999999999Z");
  EXPECT_EQ(span_of(after_back, berlin, "at 9"), "2026-10-25T08:00:00Z 2026-10-25T08:00:59.999999999Z");
  EXPECT_EQ(span_of(after_back, berlin, "12 hours ago"), "2026-10-25T00:00:00Z 2026-10-25T00:00:00Z");
  EXPECT_EQ(span_of(after_back, berlin, "1 day ago"), "2026-10-24T11:00:00Z 2026-10-24T11:00:00Z")
      << "at the same time of day";
  EXPECT_EQ(span_of(after_back, berlin, "2026-10-25T02:30:00+02:00"),
            "2026-10-25T00:30:00Z 2026-10-25T00:30:00Z")
      << "a zone in the text says which of the two it was";
  const char* after_forward = "2026-03-29T10:00:00Z";
  EXPECT_EQ(span_of(after_forward, berlin, "today"), "2026-03-28T23:00:00Z 2026-03-29T21:59:59.999999999Z")
      << "a day of 23 hours";
  EXPECT_EQ(span_of(after_forward, berlin, "02:30"), "2026-03-29T01:00:00Z 2026-03-29T01:00:00Z")
      << "a time that clocks skip: the moment at which they are set";
  EXPECT_EQ(span_of(after_forward, berlin, "last night"),
            "2026-03-28T19:00:00Z 2026-03-29T03:59:59.999999999Z");
  EXPECT_EQ(span_of("2026-07-01T10:00:00Z", berlin, "2026-01-15 09:00"),
            "2026-01-15T08:00:00Z 2026-01-15T08:00:59.999999999Z")
      << "in winter's time, asked in summer";
  EXPECT_EQ(local_hour(parse_time("2026-10-25T00:30:00Z"), berlin), 2);
  EXPECT_EQ(local_hour(parse_time("2026-10-25T01:30:00Z"), berlin), 2);
  EXPECT_EQ(TimeWriter(berlin, true, 0, false).text(parse_time("2026-01-15T08:00:00Z")), "2026-01-15 09:00");
  EXPECT_EQ(TimeWriter(berlin, true, 0, false).text(parse_time("2026-07-15T08:00:00Z")), "2026-07-15 10:00");
}

TEST(PeopleTime, ATimeThatClocksShowTwiceHasItsOffset) {
  const TimeZone berlin = TimeZone::named("Europe/Berlin");
  const TimeWriter writer(berlin, false, 0, false);
  EXPECT_EQ(writer.text(parse_time("2026-10-25T00:30:00Z")), "02:30+02:00");
  EXPECT_EQ(writer.text(parse_time("2026-10-25T01:30:00Z")), "02:30+01:00");
  EXPECT_EQ(writer.text(parse_time("2026-10-25T02:30:00Z")), "03:30");
  const char* after_back = "2026-10-25T12:00:00Z";
  EXPECT_EQ(span_of(after_back, berlin, "02:30+02:00"),
            "2026-10-25T00:30:00Z 2026-10-25T00:30:59.999999999Z");
  EXPECT_EQ(span_of(after_back, berlin, "02:30+01:00"),
            "2026-10-25T01:30:00Z 2026-10-25T01:30:59.999999999Z");
  const TimeReader reader(parse_time(after_back), berlin);
  EXPECT_FALSE(reader.try_read("02:30+05:00"));
  EXPECT_TRUE(reader.is_repeated("02:45", false));
  EXPECT_TRUE(reader.is_repeated("half past two", true));
  for (const char* text : {"02:30+02:00", "03:00", "today", "11 hours ago", "2026-10-25T00:30:00Z"})
    EXPECT_FALSE(reader.is_repeated(text, false)) << text;
}

TEST(PeopleTime, TheDateIsSaidOfAnotherDay) {
  const TimeWriter writer(TimeZone(), false, 0, false);
  const TimeNs time = parse_time("2026-05-01T07:10:00Z");
  EXPECT_EQ(writer.text(time, parse_time("2026-05-01T23:00:00Z")), "07:10");
  EXPECT_EQ(writer.text(time, parse_time("2020-01-01T07:10:00Z")), "2026-05-01 07:10");
}

TEST(PeopleTime, TheDayBeginsAtMidnightOfTheMemorysZone) {
  // Five past midnight in Berlin is yesterday in UTC, and a quarter to six in Kathmandu today already.
  EXPECT_EQ(span_of("2026-05-01T22:05:00Z", TimeZone::fixed(120), "today"),
            "2026-05-01T22:00:00Z 2026-05-02T21:59:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T22:05:00Z", TimeZone::fixed(120), "yesterday 23:55"),
            "2026-05-01T21:55:00Z 2026-05-01T21:55:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T22:05:00Z", TimeZone::fixed(120), "10 minutes ago"),
            "2026-05-01T21:55:00Z 2026-05-01T21:55:00Z");
  EXPECT_EQ(span_of("2026-05-01T22:05:00Z", TimeZone::fixed(120), "midnight"),
            "2026-05-01T22:00:00Z 2026-05-01T22:00:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T21:59:59Z", TimeZone::fixed(120), "midnight"),
            "2026-04-30T22:00:00Z 2026-04-30T22:00:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T22:05:00Z", TimeZone::fixed(120), "24:00"),
            "2026-05-02T22:00:00Z 2026-05-02T22:00:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T22:05:00Z", TimeZone::fixed(120), "last night"),
            "2026-05-01T18:00:00Z 2026-05-02T03:59:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T20:00:00Z", TimeZone::fixed(345), "this morning"),
            "2026-05-01T23:15:00Z 2026-05-02T06:14:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T03:00:00Z", TimeZone::fixed(-480), "today"),
            "2026-04-30T08:00:00Z 2026-05-01T07:59:59.999999999Z");
  EXPECT_EQ(span_of("2026-05-01T03:00:00Z", TimeZone::fixed(-480), "Thursday"),
            "2026-04-30T08:00:00Z 2026-05-01T07:59:59.999999999Z")
      << "it is still Thursday there";
  EXPECT_EQ(local_hour(parse_time("2026-05-01T22:05:00Z"), TimeZone::fixed(120)), 0);
  EXPECT_EQ(local_weekday(parse_time("2026-05-01T22:05:00Z"), TimeZone::fixed(120)), 5) << "Saturday";
  EXPECT_EQ(local_weekday(parse_time("1969-12-31T23:59:00Z"), TimeZone::fixed(0)), 2) << "before the epoch";
  // Years and leap days.
  EXPECT_EQ(span_of("2028-03-01T00:30:00Z", TimeZone::fixed(0), "yesterday"),
            "2028-02-29T00:00:00Z 2028-02-29T23:59:59.999999999Z");
  EXPECT_EQ(span_of("2026-01-01T00:30:00Z", TimeZone::fixed(60), "yesterday 23:30"),
            "2025-12-31T22:30:00Z 2025-12-31T22:30:59.999999999Z");
}

}  // namespace
}  // namespace loci::memory
