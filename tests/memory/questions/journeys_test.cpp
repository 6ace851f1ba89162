#include "memory/questions/journeys.h"

#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using Journeys = testing_support::DayFixture;

TEST_F(Journeys, LifecycleIsTheWayFromPlaceToPlace) {
  const LifecycleAnswer answer = ask(*store_, LifecycleQuestion{.subject = "red"});
  ASSERT_EQ(answer.usual.size(), 2U);
  EXPECT_EQ(answer.usual[0].name, "table_1");
  EXPECT_EQ(answer.usual[1].name, "counter_1");
  ASSERT_EQ(answer.steps.size(), 1U);
  EXPECT_EQ(answer.steps[0].share, 1);
  EXPECT_THAT(text(answer), HasSubstr("table_1 → counter_1"));
  EXPECT_THAT(text(answer), HasSubstr("on table_1: 1 stay, 1.5 h"));
}

TEST_F(Journeys, LifecycleOfAllAddsUp) {
  const LifecycleAnswer answer = ask(*store_, LifecycleQuestion{.subject = ""});
  EXPECT_EQ(answer.objects.size(), 4U);
  EXPECT_EQ(answer.places[0].stays, 2U);
}

TEST_F(Journeys, OneLooksFirstWhereItIsBelievedToBe) {
  const NextLookAnswer answer = ask(*store_, NextLookQuestion{.subject = "red"});
  ASSERT_EQ(answer.objects.size(), 1U);
  ASSERT_EQ(answer.objects[0].places.size(), 3U);
  EXPECT_EQ(answer.objects[0].places[0].place.name, "counter_1");
  EXPECT_NEAR(answer.objects[0].places[0].probability, 0.98, 1e-9);
  double sum = 0;
  for (const LookPlace& place : answer.objects[0].places) sum += place.probability;
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST_F(Journeys, WhereOneHasLookedSinceIsLessProbable) {
  const NextLookAnswer answer = ask(*store_, NextLookQuestion{.subject = "red", .as_of = at("09:00")});
  const auto& places = answer.objects.at(0).places;
  EXPECT_EQ(places[0].place.name, "drawer_1_bottom")
      << "nobody has looked there; the counter was seen at 08:30";
  EXPECT_GT(places[0].probability, 0.8);
  EXPECT_EQ(places.back().place.name, "table_1") << "it has gone from there";
  EXPECT_EQ(places.back().probability, 0);
}

TEST_F(Journeys, AWayCosts) {
  const auto seconds = [&](const Vector2d& from) {
    const auto answer = ask(*store_, NextLookQuestion{.subject = "red", .from = from});
    return answer.objects.at(0).places.at(0).seconds;
  };
  EXPECT_NEAR(seconds({0.5, 0.4}) - seconds({3.5, 0.4}), 6, 1e-9) << "three metres at half a metre a second";
}

}  // namespace
}  // namespace loci::memory
