#include "memory/questions/routines/routines.h"

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
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

TEST_F(LifeCycle, WhatIsUsuallyAtAPlaceIsBySharesOfItsLooksAtThoseHours) {
  const auto usual = [&](const std::string& during) {
    const Query query{"contents-history", {{"place", "table_1"}, {"during", during}}, Asks::objects};
    return find_question(query.question)->reply(*store_, query, ask(*store_, query));
  };
  const PlaceContentsHistory morning =
      ask(*store_, ContentsHistoryQuestion{.place = "table_1", .during = "morning"}).places.at(0);
  EXPECT_EQ(morning.visits, 3U) << "an hour apart";
  ASSERT_EQ(morning.objects.size(), 2U);
  EXPECT_EQ(morning.objects[0].now.object.id, 2);
  EXPECT_EQ(morning.objects[0].visits, 2U);
  EXPECT_EQ(usual("morning").objects, std::vector<Id>{2});
  EXPECT_THAT(usual("8").text, HasSubstr("Too few to tell, 1 look on table_1 then"));
  EXPECT_TRUE(usual("8").not_known);
  EXPECT_THAT(usual("evening").text, HasSubstr("no look at table_1 then"));
}

TEST_F(LifeCycle, OfAllObjectsAddsUp) {
  const LifeCycleAnswer answer = ask(*store_, LifeCycleQuestion{.subject = ""});
  EXPECT_EQ(answer.objects.size(), 4U);
  EXPECT_EQ(answer.places[0].stays, 2U);
}

}  // namespace
}  // namespace loci::memory
