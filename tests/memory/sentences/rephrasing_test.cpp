#include "memory/sentences/intents/rephrasing.h"

#include "memory/sentences/natural_language.h"
#include "memory/sentences/sentence_parser.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

const std::set<std::string> kNames = {"tea", "milk", "pot", "cup", "cups", "plate", "table", "shelf", "jar"};

bool is_name(const std::string& words) {
  return kNames.contains(words);
}

std::string plain(const std::string& sentence) {
  const auto one = rephrased(sentence, is_name);
  return one ? one->sentence : "";
}

TEST(Rephrasing, ASpeakersCorrectionReplacesWhatItCorrects) {
  EXPECT_EQ(as_meant("what's on the shelf no sorry on the table", is_name), "what is on the table");
  EXPECT_EQ(as_meant("Where is the tea, no wait, the milk?", is_name), "where is the milk ?");
  EXPECT_EQ(as_meant("wait no not the tea the milk where's the milk", is_name), "where is the milk");
  EXPECT_EQ(as_meant("is the pot free, scratch that, where is it", is_name), "where is it");
  EXPECT_EQ(as_meant("Sorry, no milk today?", is_name), "milk today ?");
  const std::string whole = "Is there no tea on the shelf?";
  EXPECT_EQ(as_meant(whole, is_name), whole);
}

TEST(Rephrasing, AChoiceAfterACompleteQuestionIsPartOfIt) {
  EXPECT_EQ(as_meant("Which of the two cups is on the table, the red one or the blue one?", is_name),
            "which cups is on the table ?");
  EXPECT_EQ(as_meant("Which cup is nearer to the pot, the red or the blue one?", is_name),
            "is the pot nearer to the red cup or to the blue cup ?");
}

TEST(Rephrasing, AChoiceWithoutACommaIsOne) {
  EXPECT_EQ(as_meant("which bottle got moved the red one or the black one", is_name),
            "which red bottle or black bottle got moved");
  EXPECT_EQ(as_meant("Which cup was taken, the red or the blue one?", is_name),
            "which red cup or blue cup was taken ?");
  EXPECT_EQ(as_meant("Which was taken from the table earlier, the pot or the plate?", is_name),
            "which was taken from the table first , the pot or the plate ?");
  EXPECT_EQ(as_meant("Which came to the table later, the pot or the plate?", is_name),
            "which came to the table last , the pot or the plate ?");
  EXPECT_EQ(as_meant("which counter was it on before", is_name), "where was it before");
}

TEST(Rephrasing, AListOfEverythingAsksWhat) {
  EXPECT_EQ(as_meant("List everything that left the table before noon.", is_name),
            "what left the table before noon .");
  EXPECT_EQ(as_meant("Give me a list of everything put on the table between 8 and 10.", is_name),
            "what was put on the table between 8 and 10 .");
  EXPECT_EQ(as_meant("name everything moved since ten", is_name), "what was moved since ten");
  EXPECT_EQ(as_meant("show me all the things that came to the table", is_name), "what came to the table");
}

TEST(Rephrasing, ListsAreJoined) {
  EXPECT_EQ(as_meant("Are the tea, the milk and the pot on the table?", is_name),
            "are the tea and the milk and the pot on the table ?");
  EXPECT_EQ(as_meant("Where are the cup, the tea, the milk and the pot?", is_name),
            "where are the cup and the tea and the milk and the pot ?");
  EXPECT_EQ(as_meant("Which of my dishes was moved, the pot, the cup or the plate?", is_name),
            "which the pot or the cup or the plate was moved ?");
  EXPECT_EQ(plain("Where are my two cups?"), "where are the cups ?");
}

TEST(Rephrasing, CleftsAndCountsAskPlainly) {
  EXPECT_EQ(as_meant("What was it that I put on the table?", is_name), "what did someone put on the table ?");
  EXPECT_EQ(as_meant("cups total", is_name), "how many cups");
  EXPECT_EQ(as_meant("What is on the table that wasn't there at nine?", is_name),
            "what newsince is on the table at nine ?");
}

TEST(Rephrasing, WhatIsOtherwiseThanThenHasChanged) {
  EXPECT_EQ(as_meant("What's different from this morning?", is_name), "what changed since this morning ?");
  EXPECT_EQ(as_meant("Is everything where it was this morning?", is_name),
            "was nothing moved since this morning ?");
  EXPECT_EQ(plain("Is the tea still where it was?"), "was the tea ever moved ?")
      << "and the contrary of that";
}

TEST(Rephrasing, WhatTakesUpAPlaceIsAskedForItsRoom) {
  EXPECT_EQ(as_meant("Is there any space left on the table?", is_name), "what is on the table ?");
  EXPECT_EQ(as_meant("Which surface is free?", is_name), "what furniture is empty ?");
}

TEST(Rephrasing, OneOfAColourIsOfThatColour) {
  EXPECT_EQ(plain("Is the jar a red one?"), "is the jar red ?");
  EXPECT_EQ(plain("Is the jar one of the red ones?"), "is the jar red ?");
}

TEST(Rephrasing, WhatStaysAndWhatIsLeftOutIsSaidPlainly) {
  EXPECT_EQ(as_meant("Has the tea stayed where it was?", is_name), "was the tea never moved ?");
  EXPECT_EQ(as_meant("Has the tea been left where I put it at nine?", is_name),
            "was the tea never moved since nine ?");
  EXPECT_EQ(as_meant("Is there something other than tea on the shelf?", is_name),
            "is there anything on the shelf except tea ?");
  EXPECT_EQ(as_meant("cups on the table: count", is_name), "how many cups are on the table");
  EXPECT_EQ(plain("What was on the shelf last time you looked?"), "what was on the shelf ?");
  EXPECT_EQ(plain("Where is the stuff for my toast, the jar?"), "where is the jar ?");
}

TEST(Rephrasing, CourtesyAroundAQuestionIsLeftOutAndConditionsAreNot) {
  EXPECT_EQ(plain("If it isn't too much trouble, what is on the shelf?"), ", what is on the shelf ?");
  EXPECT_EQ(plain("Perhaps you could enlighten me as to which cups were moved."), "which cups were moved .");
  EXPECT_EQ(plain("If the milk is on the shelf, where is the tea?"), "");
  EXPECT_EQ(plain("I put the milk where the tea is"), "");
}

TEST(Rephrasing, ConstructionsBecomePlainOnes) {
  EXPECT_EQ(plain("Who keeps moving the pot?"), "who moving the pot ?");
  EXPECT_EQ(plain("How many of the cups on the table are red?"), "how many red cups on the table ?");
  EXPECT_EQ(plain("What is the red thing on the table?"), "which red thing is on the table ?");
  EXPECT_EQ(plain("How long was the pot out before somebody took it away?"), "how long was the pot out ?");
  EXPECT_EQ(plain("Are there more cups than plates?"), "does the cups outnumber the plates ?");
  EXPECT_EQ(plain("pot or cup bigger"), "which is bigger pot or cup");
  EXPECT_EQ(plain("Where is the milk?"), "");
}

TEST(Rephrasing, PeopleAreSomeoneUnlessTheMemoryKnowsThem) {
  EXPECT_EQ(plain("Has some idiot moved the pot?"), "has someone moved the pot ?");
  EXPECT_EQ(plain("Did the plumber move the pot?"), "did someone move the pot ?");
  const auto known = [](const std::string& words) { return words == "plumber" || is_name(words); };
  EXPECT_FALSE(rephrased("Did the plumber move the pot?", known));
}

TEST(Rephrasing, ANegativeSubjectAsksForTheContrary) {
  const auto contrary = [](const std::string& sentence) {
    const auto one = contrary_question(sentence, is_name);
    return one ? one->question : "";
  };
  EXPECT_EQ(contrary("So nobody moved the pot, right?"), "so did somebody moved the pot , right ?");
  EXPECT_EQ(contrary("Nobody has moved the pot."), "has somebody moved the pot .");
  EXPECT_EQ(contrary("No one opened it?"), "did somebody opened it ?");
  EXPECT_EQ(contrary("What has nobody moved?"), "");
  EXPECT_EQ(contrary("Nobody never moved the pot."), "");
  EXPECT_EQ(contrary("Was the pot moved?"), "");
  EXPECT_EQ(contrary("Has nothing happened since six?"), "has anything happened since six ?");
  EXPECT_EQ(contrary("Please confirm that the pot has not been moved."),
            "please confirm that the pot has been moved .");
  EXPECT_EQ(contrary("So the pot never left the table, correct?"),
            "did the pot ever left the table , correct ?");
  EXPECT_EQ(contrary("The milk is not on the table, is it?"), "") << "asks whether it is";
  const auto nothing = rephrased("Has nothing happened since six?", is_name);
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->contrary);
  EXPECT_EQ(nothing->sentence, "has anything happened since six ?");
}

TEST(Rephrasing, AChoiceIsOfWhatWasNamed) {
  EXPECT_EQ(as_meant("Which of these are still here: the plate, the milk, tea?", is_name),
            "which plate or milk or tea are still here");
  EXPECT_EQ(with_choice("Which one has been moved?", "cups"), "which cups has been moved");
  EXPECT_EQ(with_choice("Is there any left?", "milk"), "is there any milk?");
  EXPECT_EQ(with_choice("Which cup has been moved?", "plates"), "Which cup has been moved?");
  EXPECT_TRUE(chooses("And which of those is the biggest?"));
  EXPECT_FALSE(chooses("Which of the cups is the biggest?"));
}

TEST(Rephrasing, AQuestionWordAfterAndAsksMore) {
  const auto elided = two_questions("Was the pot moved, and when?");
  ASSERT_TRUE(elided);
  EXPECT_EQ(elided->question, "was the pot moved?");
  EXPECT_EQ(elided->more, "when?");
  EXPECT_TRUE(elided->elided);
  const auto two = two_questions("What is on the table and where is the pot?");
  ASSERT_TRUE(two);
  EXPECT_EQ(two->question, "what is on the table?");
  EXPECT_EQ(two->more, "where is the pot?");
  EXPECT_FALSE(two->elided);
}

class RephrasedQuestions : public testing_support::DayFixture {
 protected:
  NaturalLanguageAnswer say(const std::string& sentence) const {
    return ask(*store_, NaturalLanguageQuestion{{sentence}, {}}).at(0);
  }
};

TEST_F(RephrasedQuestions, TheContraryHasTheOtherVerdict) {
  const NaturalLanguageAnswer moved = say("So nobody moved the red thing, right?");
  ASSERT_TRUE(moved.reply) << text(moved);
  EXPECT_EQ(moved.reply->verdict, Verdict::no);
  EXPECT_THAT(moved.reply->text, testing::StartsWith("No: the tea cup"));
  EXPECT_EQ(moved.query->argument("kind"), "handled");
}

TEST_F(RephrasedQuestions, MoreThanOneThingIsAnsweredByALineEach) {
  const NaturalLanguageAnswer both = say("Was the red thing moved, and when?");
  ASSERT_TRUE(both.reply) << text(both);
  EXPECT_EQ(both.reply->verdict, Verdict::yes);
  EXPECT_TRUE(both.reply->time);
  const NaturalLanguageAnswer where = say("When did you last see the red thing and where?");
  ASSERT_TRUE(where.reply) << text(where);
  EXPECT_EQ(where.reply->places, std::vector<std::string>{"counter_1"});
}

TEST_F(RephrasedQuestions, OfPlacesToChooseFromTheOneIsNamed) {
  const NaturalLanguageAnswer answer = say("Is the red thing on the table or on the counter?");
  ASSERT_TRUE(answer.reply) << text(answer);
  EXPECT_EQ(answer.reply->places, std::vector<std::string>{"counter_1"});
}

TEST_F(RephrasedQuestions, WhatIsInAnObjectIsNotRecorded) {
  EXPECT_TRUE(say("Is there something in the tea cup?").reply->not_known);
  EXPECT_EQ(say("Is there something on the tea cup?").reply->verdict, Verdict::no);
}

TEST_F(RephrasedQuestions, TheFirstAndTheLastToComeAreNamed) {
  EXPECT_EQ(say("What came to the counter last?").query->asks, Asks::latest);
  EXPECT_EQ(say("What left the table first?").reply->objects, std::vector<Id>{1});
}

TEST_F(RephrasedQuestions, WhatIsNewWasNotThereThen) {
  const NaturalLanguageAnswer fresh = say("What is on the counter that wasn't there at eight?");
  ASSERT_TRUE(fresh.reply) << text(fresh);
  EXPECT_EQ(fresh.query->argument("state"), "new");
  EXPECT_THAT(fresh.reply->objects, testing::Contains(1));
}

TEST_F(RephrasedQuestions, WhatIsLostInANameIsNotAnswered) {
  EXPECT_FALSE(say("Where did I leave my holiday?").query);  // nothing that stands somewhere
  EXPECT_FALSE(say("Were there ever two red things on the table at once?").reply);
  EXPECT_FALSE(say("What came to the table right after the blue thing?").reply);
}

}  // namespace
}  // namespace loci::memory
