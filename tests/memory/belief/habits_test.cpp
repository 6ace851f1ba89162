#include "memory/belief/habits.h"

#include <gtest/gtest.h>

#include "memory/belief/archive.h"

namespace loci::memory::belief {
namespace {

constexpr double kHour = 3600;
const BeliefOptions kOptions;

/// An object of a kind that is looked at every hour; it was handled at every `period`th look.
Habits watched(const std::string& kind, int looks, int period, Habits habits = {}) {
  Factor own;
  for (int i = 1; i <= looks; ++i)
    habits.learn_handled({kind, "table_1", own}, own, kHour, i % period == 0 ? 1 : 0, kOptions);
  return habits;
}

TEST(Habits, BeginWithWhatTheOptionsSay) {
  const Habits habits;
  const double expected = kOptions.move_cap * (1 - std::exp(-kHour / kOptions.move_time_s));
  EXPECT_NEAR(habits.handled({"mug", "table_1"}, 0, kHour, kOptions), expected, 0.01);
  EXPECT_EQ(habits.handled({"mug", "table_1"}, kHour, kHour, kOptions), 0);
}

TEST(Habits, ProbabilityOfStayingMultipliesOverTime) {
  const Habits habits = watched("mug", 50, 5);
  const auto stays = [&](double from, double to) {
    return 1 - habits.handled({"mug", {}}, from, to, kOptions);
  };
  EXPECT_NEAR(stays(0, 10 * kHour), stays(0, kHour / 2) * stays(kHour / 2, 10 * kHour), 1e-12);
}

TEST(Habits, LearnHowLongThingsStay) {
  EXPECT_NEAR(watched("mug", 400, 10).handled({"mug", "table_1"}, 0, kHour, kOptions), 0.1, 0.03);
  EXPECT_NEAR(watched("mug", 400, 2).handled({"mug", "table_1"}, 0, kHour, kOptions), 0.5, 0.1);
}

TEST(Habits, KindsDiffer) {
  const Habits habits = watched("mug", 200, 2, watched("vase", 200, 50));
  const double mug = habits.handled({"mug", "table_1"}, 0, kHour, kOptions);
  const double vase = habits.handled({"vase", "table_1"}, 0, kHour, kOptions);
  EXPECT_GT(mug, 3 * vase);
}

TEST(Habits, DestinationsAreLearned) {
  Habits habits;
  EXPECT_NEAR(habits.moved_to("table_1", "table_1"), 2.0 / 3, 1e-9) << "no other place is known";
  for (int i = 0; i < 20; ++i) habits.learn_moved("table_1", "sink_1", 1);
  habits.learn_moved("table_1", "shelf_1", 1);
  EXPECT_GT(habits.moved_to("table_1", "sink_1"), 5 * habits.moved_to("table_1", "shelf_1"));
  EXPECT_GT(habits.moved_to("table_1", "shelf_1"), 0);
}

TEST(Habits, NewThingsAreExpectedWhereNobodyLookedBefore) {
  Habits habits;
  for (int i = 0; i < 20; ++i) habits.learn_arrivals("place_" + std::to_string(i), 5, kOptions);
  for (int i = 0; i < 50; ++i) habits.learn_arrivals("place_3", 0, kOptions);
  EXPECT_GT(habits.arrivals("place_99", kOptions), 10 * habits.arrivals("place_3", kOptions));
}

TEST(Habits, WhatIsGoneForLongReturnsMoreSeldom) {
  Habits habits;
  for (int i = 0; i < 100; ++i) {
    habits.learn_returns(100, i % 2, kOptions);
    habits.learn_returns(5 * kHour, 0, kOptions);
  }
  EXPECT_NEAR(habits.returns(100, kOptions), 0.5, 0.05);
  EXPECT_LT(habits.returns(5 * kHour, kOptions), 0.03);
}

TEST(Habits, HowOftenNewThingsAreFalseIsLearned) {
  Habits habits;
  for (int i = 0; i < 20; ++i) habits.learn_arrivals("table_" + std::to_string(i), 5, kOptions);
  EXPECT_NEAR(habits.false_share("table_1", kOptions), 0.1, 1e-9);
  EXPECT_LT(habits.false_share("table_99", kOptions), 0.02) << "where nobody looked before all is new";
  for (int i = 0; i < 200; ++i) habits.learn_false(i % 2, kOptions);
  EXPECT_NEAR(habits.false_share("table_1", kOptions), 0.5, 0.05);
}

TEST(Archive, RefusesBytesThatEndTooEarly) {
  ArchiveWriter writer;
  writer(watched("mug", 9, 3));
  const std::string bytes = writer.take();
  Habits habits;
  ArchiveReader whole(bytes);
  EXPECT_NO_THROW(whole(habits));
  EXPECT_TRUE(whole.at_end());
  for (size_t size = 0; size < bytes.size(); ++size) {
    ArchiveReader cut(std::string_view(bytes).substr(0, size));
    EXPECT_THROW(cut(habits), Error) << size;
  }
}

}  // namespace
}  // namespace loci::memory::belief
