#include "memory/questions/routines/routines.h"

#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using LifeCycle = testing_support::DayFixture;

TEST_F(LifeCycle, IsTheSequenceOfPlaces) {
  const LifeCycleAnswer answer = ask(*store_, LifeCycleQuestion{.subject = "red"});
  ASSERT_EQ(answer.usual.size(), 2U);
  EXPECT_EQ(answer.usual[0].name, "table_1");
  EXPECT_EQ(answer.usual[1].name, "counter_1");
  ASSERT_EQ(answer.steps.size(), 1U);
  EXPECT_EQ(answer.steps[0].share, 1);
  EXPECT_THAT(text(answer), HasSubstr("table_1 → counter_1"));
  EXPECT_THAT(text(answer), HasSubstr("on table_1: 1 stay, 1.5 h"));
}

TEST_F(LifeCycle, TheMedianOfTwoStaysLiesBetweenThem) {
  see_red_at("table_1", "11:00");
  see_red_at("counter_1", "15:00");
  EXPECT_THAT(text(ask(*store_, LifeCycleQuestion{.subject = "red"})),
              HasSubstr("on table_1: 2 stays, 2.8 h"))
      << "1.5 h and 4 h";
}

TEST_F(LifeCycle, OfAllObjectsAddsUp) {
  const LifeCycleAnswer answer = ask(*store_, LifeCycleQuestion{.subject = ""});
  EXPECT_EQ(answer.objects.size(), 4U);
  EXPECT_EQ(answer.places[0].stays, 2U);
}

}  // namespace
}  // namespace loci::memory
