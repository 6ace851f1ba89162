#include "memory/sentences/clauses/contents_clause.h"

#include "memory/sentences/clauses/absence_clause.h"
#include "memory/sentences/natural_language.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class ContentsClause : public testing_support::DayFixture {
 protected:
  Reply reply(const std::string& sentence) const {
    const NaturalLanguageAnswer answer = ask(*store_, NaturalLanguageQuestion{{sentence}, {}}).at(0);
    EXPECT_TRUE(answer.reply) << sentence;
    return answer.reply.value_or(Reply());
  }
  bool compares(const std::string& sentence) const {
    return find_contents_comparison(sentence, Snapshot(*store_, {}), TimeReader(*store_)).has_value();
  }
};

TEST_F(ContentsClause, WhatWasThereAtOneTimeAndNotAtTheOther) {
  for (const char* sentence : {"What was on the table at half past eight that is not there now?",
                               "What was on the table at half past eight but is no longer there?",
                               "Which things were on the table at half past eight and are gone now?",
                               "What is gone from the table compared with half past eight?"})
    EXPECT_THAT(reply(sentence).objects, ElementsAre(1)) << sentence;
  EXPECT_THAT(reply("What is on the table now that was not there at half past eight?").objects, IsEmpty());
}

TEST_F(ContentsClause, WhatIsStillThere) {
  EXPECT_THAT(reply("Of the things on the table at half past eight, which are still there?").objects,
              ElementsAre(2));
  EXPECT_EQ(reply("Of the things on the table at half past eight, how many remain?").number, 1U);
  const Reply all = reply("Is everything that was on the table at half past eight still there?");
  EXPECT_EQ(all.verdict, Verdict::no);
  EXPECT_THAT(all.objects, ElementsAre(1)) << "what is not";
}

TEST_F(ContentsClause, WhetherThereWasMoreThen) {
  EXPECT_EQ(reply("Was there more on the table at half past eight than now?").verdict, Verdict::yes);
  EXPECT_EQ(reply("Was the table emptier at half past eight than it is now?").verdict, Verdict::no);
  EXPECT_EQ(reply("Are there more tea cups on the counter than on the table?").verdict, Verdict::yes);
}

TEST_F(ContentsClause, WhetherThereAreMoreOfOneThanOfTheOther) {
  EXPECT_EQ(reply("Are there more tea cups than blue things?").verdict, Verdict::no);
  EXPECT_EQ(reply("Do we have as many tea cups as blue things?").verdict, Verdict::yes);
  EXPECT_EQ(reply("Are there fewer tea cups than blue things on the table?").verdict, Verdict::yes);
  EXPECT_EQ(reply("Are there the same number of tea cups as blue things on the table?").verdict, Verdict::no);
  EXPECT_EQ(reply("Does the counter have fewer things on it than the table?").verdict, Verdict::no);
  EXPECT_THAT(reply("Which has more tea cups, the table or the counter?").places, ElementsAre("counter_1"));
  EXPECT_EQ(reply("Are there fewer blue things than at half past eight?").verdict, Verdict::no);
  EXPECT_EQ(reply("Is there more on the table than at half past eight?").verdict, Verdict::no);
  EXPECT_THAT(reply("What is there more of on the table, tea cups or blue things?").objects, ElementsAre(2));
}

TEST_F(ContentsClause, WhatSaysMoreIsNoComparison) {
  EXPECT_FALSE(compares("What was on the table at half past eight that is not red?"));
  EXPECT_FALSE(compares("What was on the table at half past eight?"));
  EXPECT_FALSE(compares("What was on the table at nine and where is it now?"));
}

TEST_F(ContentsClause, HowLongSomethingWasAwayIsFromTheLookBeforeItLeft) {
  const Reply away = reply("How long was the tea cup away from the table?");
  ASSERT_TRUE(away.duration);
  EXPECT_EQ(*away.duration, TimeReader(*store_).now() - testing_support::day_time("08:00"));
  EXPECT_TRUE(reply("How long was the blue thing away from the table?").not_known) << "it never left";
  EXPECT_FALSE(find_absence("How long was the tea cup on the table?", Snapshot(*store_, {})));
}

TEST_F(ContentsClause, SeveralNamesAreLeftOut) {
  EXPECT_THAT(reply("What is on the counter apart from the tea cup and the green thing?").objects, IsEmpty());
  EXPECT_THAT(reply("Never mind the tea cup. What else is on the counter?").objects, ElementsAre(3));
}

TEST_F(ContentsClause, TheTimeOfAStatementIsThatOfTheQuestionAfterIt) {
  const auto asked = [&](const char* sentence) {
    return ask(*store_, NaturalLanguageQuestion{{sentence}, {}}).at(0).query->text();
  };
  EXPECT_EQ(asked("I came home at half past eight. What was on the table?"),
            "on table --at 'half past eight'");
  EXPECT_EQ(asked("I came home at half past eight. What is on the table?"), "on table");
  EXPECT_EQ(asked("I came home at half past eight. What was on the table at ten?"), "on table --at ten");
  EXPECT_THAT(asked("I came home at half past eight. When was the drawer opened?"),
              testing::Not(testing::HasSubstr("--at")));
}

TEST_F(ContentsClause, WhichOfThoseAreThoseOfTheAnswerBefore) {
  const auto answers = ask(
      *store_, NaturalLanguageQuestion{{"What is on the counter?", "Which of those has been moved?"}, {}});
  ASSERT_TRUE(answers[1].reply);
  EXPECT_THAT(answers[1].reply->objects, ElementsAre(1));
}

TEST_F(ContentsClause, WhichOfThoseIsNotAllThatIsKnown) {
  const auto answers = ask(
      *store_, NaturalLanguageQuestion{{"What is on the counter?", "Which of those is the biggest?"}, {}});
  EXPECT_FALSE(answers[1].reply && answers[1].query->text() == "objects biggest");
}

TEST_F(ContentsClause, AnythingThatLeavesAPlaceIsAsked) {
  EXPECT_EQ(reply("Did anything leave the table today?").verdict, Verdict::yes);
  EXPECT_EQ(reply("Did anything leave the counter today?").verdict, Verdict::no);
  EXPECT_EQ(reply("Is the counter clean?").verdict, Verdict::no);
}

}  // namespace
}  // namespace loci::memory
