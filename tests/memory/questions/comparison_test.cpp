#include "memory/questions/comparison.h"

#include "mapping/base/error.h"
#include "memory/questions/events.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

class Comparison : public testing_support::DayFixture {
 protected:
  ComparisonAnswer compare(const std::string& a, const std::string& b, const std::string& by,
                           const std::string& than = "") const {
    return ask(*store_, ComparisonQuestion{.subject = a, .with = b, .than = than, .by = by});
  }
};

TEST_F(Comparison, DistancesAreThoseOfNear) {
  const ComparisonAnswer answer = compare("red", "green", "distance");
  ASSERT_TRUE(answer.compared.at(1).value);
  EXPECT_EQ(compare("green", "red", "distance").compared[1].value, answer.compared[1].value);
  EXPECT_EQ(compare("red", "green", "nearer", "green").verdict, Verdict::no);
  EXPECT_THROW(compare("red", "green", "nearer"), Error);
}

TEST_F(Comparison, DistancesToPlacesAreToTheirNearestPoint) {
  EXPECT_NEAR(*compare("red", "table_1", "distance").compared.at(1).value, 2.6, 1e-6);
  EXPECT_EQ(compare("red", "counter_1", "distance").compared.at(1).value, 0) << "it stands there";
  EXPECT_EQ(compare("red", "counter_1", "nearer", "table_1").verdict, Verdict::yes);
}

TEST_F(Comparison, BiggerAndSmallerExcludeEachOther) {
  const Verdict bigger = compare("red", "green", "bigger").verdict;
  EXPECT_NE(bigger, Verdict::not_observed);
  EXPECT_EQ(compare("green", "red", "smaller").verdict, bigger);
}

TEST_F(Comparison, MoreCountsWhatIsBelievedToBeThere) {
  const ComparisonAnswer answer = compare("counter_1", "drawer_1", "more");
  EXPECT_EQ(answer.compared.at(0).value, 2);
  EXPECT_EQ(answer.compared.at(1).value, 1);
  EXPECT_EQ(answer.verdict, Verdict::yes);
}

TEST_F(Comparison, WhatNeverLeftIsNotKnownToHaveLeftFirst) {
  EXPECT_EQ(compare("blue", "green", "left-before").verdict, Verdict::not_observed);
}

TEST_F(Comparison, WhatWasSeenLaterDidNotLeaveBefore) {
  const ComparisonAnswer answer = compare("red", "green", "left-before");
  EXPECT_EQ(answer.verdict, Verdict::yes);
  EXPECT_THAT(text(answer), testing::HasSubstr("object_3 was still there at 09:30"));
  EXPECT_EQ(compare("green", "red", "left-before").verdict, Verdict::no);
}

TEST(EventOrder, IsKnownOfTimesThatDoNotOverlap) {
  EXPECT_TRUE(order_of({1, 2}, {2, 3}) < 0) << "the look at 2 saw the second unchanged";
  EXPECT_TRUE(order_of({2, 3}, {1, 2}) > 0);
  EXPECT_EQ(order_of({1, 3}, {1, 2}), std::partial_ordering::unordered) << "both after the look at 1";
  EXPECT_EQ(order_of({kAlways, 3}, {2, 4}), std::partial_ordering::unordered);
}

TEST_F(Comparison, StaysAreComparedByTheLooksAroundThem) {
  const auto longer = [&](const char* a, const char* b) {
    return ask(*store_, ComparisonQuestion{.subject = a, .with = b, .by = "longer", .place = "table_1"})
        .verdict;
  };
  EXPECT_EQ(longer("blue", "red"), Verdict::not_observed) << "both may have stayed until 9:00";
  EXPECT_EQ(longer("blue", "green"), Verdict::not_observed) << "never seen there";
  EXPECT_THAT(text(ask(*store_,
                       ComparisonQuestion{
                           .subject = "yellow", .with = "red", .by = "longer", .place = "drawer_1_bottom"})),
              testing::HasSubstr("was there less than a minute"))
      << "seen there once";
  EXPECT_THROW(compare("blue", "red", "longer"), Error);
}

}  // namespace
}  // namespace loci::memory
