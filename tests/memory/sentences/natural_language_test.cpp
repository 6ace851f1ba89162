#include "memory/sentences/natural_language.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "mapping/base/text/json.h"
#include "memory/questions/contents.h"
#include "memory/questions/facts.h"
#include "memory/questions/location.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/presence.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/routines/tasks.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;

class NaturalLanguage : public testing_support::DayFixture {
 protected:
  NaturalLanguageAnswer say(const std::string& sentence) const {
    return ask(*store_, NaturalLanguageQuestion{{sentence}, {}}).at(0);
  }
};

TEST_F(NaturalLanguage, AnswersAsTheCommandWould) {
  const NaturalLanguageAnswer answer = say("Where did I leave my tea cup?");
  EXPECT_EQ(answer.query->text(), "where 'tea cup'");
  const auto& where = answer.answer->get<WhereAnswer>();
  ASSERT_EQ(where.objects.size(), 1U);
  EXPECT_EQ(where.objects[0].place->name, "counter_1");
  EXPECT_THAT(text(answer), testing::StartsWith("The tea cup is on counter_1.\n  tea cup (object_1): "));
  EXPECT_THAT(to_text(answer, TimeWriter(*store_), true),
              HasSubstr("= loci-memory where 'tea cup'\nThe tea cup is on counter_1.\ntea cup (object_1"));
  EXPECT_EQ(to_json(answer)["reply"]["places"], Json::array({"counter_1"}));
  EXPECT_EQ(to_json(answer)["answer"]["objects"][0]["place"], "counter_1");
}

TEST_F(NaturalLanguage, ItIsWhatTheSentenceBeforeWasAbout) {
  const auto answers =
      ask(*store_,
          NaturalLanguageQuestion{{"Where is the blue thing?", "When was the last time you saw it?"}, {}});
  EXPECT_EQ(answers[1].answer->get<WhereAnswer>().objects[0].object.id, 2);
  const NaturalLanguageAnswer alone = say("When was the last time you saw it?");
  EXPECT_FALSE(alone.reply);
  EXPECT_THAT(alone.why_not->hint, HasSubstr("nothing was spoken of before"));
}

TEST_F(NaturalLanguage, ThereIsWhereWhatWasSpokenOfIs) {
  const auto answers =
      ask(*store_, NaturalLanguageQuestion{{"Where is the tea cup?", "What else is there?"}, {}});
  EXPECT_EQ(answers[1].query->text(), "on counter_1");
}

TEST_F(NaturalLanguage, WhatIsSpokenOfMayComeFirst) {
  EXPECT_EQ(say("the tea cup where was that at nine").query->text(), "where 'tea cup' --at nine");
  EXPECT_EQ(say("the tea cup, when did it last show up?").query->text(), "where 'tea cup'");
  EXPECT_EQ(say("Show me what the table has on it").query->text(), "on table");
}

TEST_F(NaturalLanguage, OtherPlacesAreTheContraryOfStaying) {
  const std::string question = "Was the tea cup ever anywhere but on the counter?";
  see_red_at("counter_1", "11:00");
  EXPECT_EQ(say(question).query->question, "was");
  const Verdict before = *say(question).reply->verdict;
  see_red_at("table_1", "12:00");
  EXPECT_EQ(say(question).reply->verdict, Verdict::yes) << say(question).reply->text;
  EXPECT_NE(before, Verdict::yes);
}

TEST_F(NaturalLanguage, AStateBeforeAnEventIsAskedForAtAnyTimeBefore) {
  const NaturalLanguageAnswer unknown = say("Was the tea cup on the counter before the bottle came?");
  EXPECT_THAT(unknown.why_not->text, HasSubstr("'bottle'"));
  see_red_at("table_1", "11:00", EventRow{.kind = EventKind::moved, .from_place = 1});
  const NaturalLanguageAnswer state = say("Was the blue thing on the counter before the tea cup moved?");
  EXPECT_EQ(state.query->question, "was");
}

TEST_F(NaturalLanguage, AllOfADayIsThatDay) {
  EXPECT_EQ(say("Was the tea cup on the table all day yesterday?").query->text(),
            "was 'tea cup' on table --between yesterday yesterday");
  EXPECT_EQ(say("Was the tea cup on the table the whole morning yesterday?").query->text(),
            "was 'tea cup' on table --between 'yesterday morning' 'yesterday morning'");
  EXPECT_EQ(say("Was the tea cup on the table all day?").query->text(),
            "was 'tea cup' on table --between today today");
}

TEST_F(NaturalLanguage, ALongTextIsNoQuestion) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "Where is the cup ";
  EXPECT_THAT(say(text).why_not->hint, HasSubstr("at most 1000 characters"));
}

TEST_F(NaturalLanguage, ANameThatIsNotKnownIsNotLeftOut) {
  EXPECT_EQ(say("Have you seen the kitchen roll?").query->text(), "where 'kitchen roll'");
}

TEST_F(NaturalLanguage, StaysBetweenWhichItWasElsewhereAreApart) {
  see_red_at("table_1", "11:00");
  const Reply reply = *say("When was the tea cup on the table?").reply;
  EXPECT_THAT(reply.text, HasSubstr("08:00 and "));
  EXPECT_THAT(reply.text, HasSubstr("11:00: the tea cup was seen on table then."));
  EXPECT_THAT(say("When was the blue thing on the table?").reply->text, HasSubstr("09:00: "));
}

TEST_F(NaturalLanguage, AMoveIsCountedAlikeByAllQuestions) {
  see_red_at("drawer_1_bottom", "11:00", EventRow{.kind = EventKind::gone, .from_place = 2});
  see_red_at("drawer_1_bottom", "12:00", EventRow{.kind = EventKind::reappeared, .from_place = 2});
  EXPECT_EQ(say("How many times was the tea cup moved?").reply->number, 2U);
  EXPECT_THAT(say("Which object was moved most often?").reply->text, HasSubstr("ea cup, 2 times"));
  EXPECT_THAT(say("Which was moved more often, the tea cup or the blue one?").reply->text,
              HasSubstr("ea cup, 2 times"));
}

TEST_F(NaturalLanguage, AHabitThatIsLeftOutIsSaid) {
  EXPECT_THAT(say("What was on the table every morning?").notes,
              testing::Contains("'every morning' is left out: the answer is not of a habit"));
  const NaturalLanguageAnswer usual = say("Where is the red thing every day?");
  ASSERT_TRUE(usual.query);
  EXPECT_EQ(usual.query->question, "usual");
  EXPECT_THAT(usual.notes, testing::IsEmpty());
}

TEST_F(NaturalLanguage, AnOwnerThatIsLeftOutIsSaid) {
  EXPECT_THAT(say("Is Bob's tea cup on the counter?").notes,
              testing::Contains(HasSubstr("'bob's' is left out")));
  EXPECT_THAT(say("What's on the counter?").notes, testing::IsEmpty());
}

TEST_F(NaturalLanguage, NightsAreTimes) {
  EXPECT_EQ(say("What changed overnight?").query->text(), "changes --between 'last night' 'last night'");
  EXPECT_EQ(say("What changed during the night to Sunday?").query->text(),
            "changes --between 'saturday night' 'saturday night'");
}

TEST_F(NaturalLanguage, OnlyWhatWasAtAPlaceBeforeComesBackToIt) {
  see_red_at("drawer_1_bottom", "11:00", EventRow{.kind = EventKind::reappeared, .from_place = 2});
  EXPECT_THAT(say("What happened to the tea cup?").reply->text, HasSubstr("turned up in drawer"));
  see_red_at("counter_1", "12:00", EventRow{.kind = EventKind::reappeared, .from_place = 2});
  EXPECT_THAT(say("What happened to the tea cup?").reply->text, HasSubstr("came back on counter"));
}

TEST_F(NaturalLanguage, WhatIsSaidBeforeAQuestionIsWhatItRefersTo) {
  const auto command = [&](const char* sentence) {
    const NaturalLanguageAnswer answer = say(sentence);
    return answer.query ? answer.query->text() : "";
  };
  EXPECT_EQ(command("My memory is bad! I had my tea cup at nine. Where is it?"), "where 'tea cup'");
  EXPECT_EQ(command("She keeps asking for the tea cup. Is there one left?"), "where 'tea cup'");
  EXPECT_EQ(command("I can not look onto the table. What is up there?"), "on table");
  EXPECT_EQ(command("When we were small we kept it elsewhere. Where is the tea cup?"), "where 'tea cup'");
  EXPECT_EQ(command("I poured some tea, then the telephone rang, where is the tea cup?"), "where 'tea cup'");
  EXPECT_EQ(command("i was like looking for the tea cup and yeah where is that"), "where 'tea cup'");
  EXPECT_EQ(command("My eyes are not what they were, what is standing on the table?"), "on table");
  EXPECT_EQ(command("I need the tea cup. Where is it?"), "where 'tea cup'");
  EXPECT_EQ(command("I put my tea cup down somewhere. Where would that be?"), "where 'tea cup'");
  EXPECT_FALSE(say("If I needed a spade, where would I get one?").reply) << "not what was seen last";
}

TEST_F(NaturalLanguage, WhatIsSaidRoundaboutAsksAPlainQuestion) {
  const auto command = [&](const char* sentence) {
    const NaturalLanguageAnswer answer = say(sentence);
    return answer.query ? answer.query->text() : "";
  };
  EXPECT_EQ(command("Where do I find the tea cup, on the table or on the counter?"), "where 'tea cup'");
  EXPECT_EQ(command("Is anything left on the breakfast table?"), "on table");
  EXPECT_EQ(command("What was on the breakfast table?"),
            "contents-history table --between breakfast breakfast");
  EXPECT_EQ(command("Was the tea cup on the table moved?"), "changes --kind handled --object 'tea cup'");
  EXPECT_EQ(command("When did the tea cup dissapear?"), "changes --kind left --object 'tea cup'");
  EXPECT_EQ(command("Who carried the tea cup from the table to the counter?"),
            "changes --kind came --object 'tea cup' --other table --place counter");
  EXPECT_EQ(command("Is the tea cup maroon?"), "about 'tea cup' --property colour --value red");
  EXPECT_EQ(command("How many objects were on the table at most?"), "empty table");
  EXPECT_FALSE(say("Where is the cutting board?").reply) << "no shelf is one";
}

TEST_F(NaturalLanguage, WhenAPlaceWasFullestAndWhetherAnybodyLookedIsKnown) {
  const NaturalLanguageAnswer most = say("How many objects were on the table at most?");
  EXPECT_EQ(most.reply->number, 2U);
  EXPECT_THAT(most.reply->text, HasSubstr("2 at most: 2 objects were on table_1 at"));
  EXPECT_TRUE(say("When was the table the fullest?").reply->time);
  EXPECT_EQ(say("Did you look at the table?").reply->verdict, Verdict::yes);
  EXPECT_EQ(say("Did you look at the table between 08:10 and 08:20?").reply->verdict, Verdict::no);
}

TEST_F(NaturalLanguage, ThemIsWhatTheLastAnswerNamed) {
  const auto last = [&](const std::vector<std::string>& sentences) {
    return ask(*store_, NaturalLanguageQuestion{sentences, {}}).back();
  };
  const auto none = last({"What is on the table?", "How many of them are green?"});
  ASSERT_TRUE(none.reply);
  EXPECT_EQ(none.reply->number, 0U);
  EXPECT_THAT(last({"What is on the counter?", "Which of them is green?"}).reply->objects,
              testing::ElementsAre(3));
  EXPECT_THAT(last({"What is on the counter?", "Are any of them blue?"}).reply->verdict, Verdict::no);
  EXPECT_THAT(last({"What is on the table?", "Where is it?"}).reply->objects, testing::ElementsAre(2));
  EXPECT_EQ(last({"What is on the counter?", "Is the blue thing?"}).query->text(),
            "on counter --object 'blue thing'");
}

TEST_F(NaturalLanguage, TwoStatementsAreBothJudged) {
  EXPECT_EQ(say("Is the blue thing on the table and the tea cup on the counter?").reply->verdict,
            Verdict::yes);
  EXPECT_EQ(say("Is the blue thing on the table and the tea cup on the table?").reply->verdict, Verdict::no);
}

TEST_F(NaturalLanguage, WhatNoCameraMeasuresIsNotNamed) {
  const NaturalLanguageAnswer answer = say("What is the heaviest object?");
  ASSERT_TRUE(answer.why_not);
  EXPECT_THAT(answer.why_not->text, HasSubstr("the weight of objects is not measured"));
}

TEST_F(NaturalLanguage, WhetherSomethingHasAColourIsYesOrNo) {
  EXPECT_EQ(say("Is the tea cup red?").reply->verdict, Verdict::yes);
  EXPECT_EQ(say("Is the tea cup white?").reply->verdict, Verdict::no);
  EXPECT_FALSE(say("Is the tea cup hidden?").reply) << "not whether there is one";
}

TEST_F(NaturalLanguage, OneOfTwoPlacesHasOneOfEach) {
  const NaturalLanguageAnswer answer = say("Are the blue thing and the tea cup in the same place?");
  EXPECT_EQ(answer.query->text(), "where 'blue thing and tea cup'");
  EXPECT_EQ(answer.reply->verdict, Verdict::no);
}

TEST_F(NaturalLanguage, RareWordsAreTyposWhereNothingElseIsUnderstood) {
  const NaturalLanguageAnswer answer = say("What is the bigest thing?");
  ASSERT_TRUE(answer.reply);
  EXPECT_THAT(answer.notes, testing::Contains("'bigest' is taken as 'biggest'"));
}

TEST_F(NaturalLanguage, AWordThatIsNoNounIsNoName) {
  EXPECT_EQ(say("Did you notice anything unusual today?").why_not->reason, "not_understood");
  EXPECT_EQ(say("List objects whose location is uncertain.").why_not->reason, "not_understood");
}

TEST_F(NaturalLanguage, NothingOfAColourIsNoUnknownName) {
  const NaturalLanguageAnswer answer = say("Is there anything purple on the table?");
  EXPECT_EQ(answer.reply->verdict, Verdict::no);
}

TEST_F(NaturalLanguage, WhatHasAnotherColourIsNotOfThatColour) {
  EXPECT_EQ(say("Is there a purple tea cup?").reply->verdict, Verdict::no);
  EXPECT_EQ(say("Are there any purple things?").reply->verdict, Verdict::no);
}

TEST_F(NaturalLanguage, AFollowUpNamesAnotherPlace) {
  for (const char* sentence :
       {"How about on the counter?", "What about the counter?", "And how many on the counter?"}) {
    const auto answers =
        ask(*store_, NaturalLanguageQuestion{{"How many objects are on the table?", sentence}, {}});
    EXPECT_EQ(answers.at(1).query->text(), "on counter") << sentence;
  }
}

TEST_F(NaturalLanguage, FurnitureIsThereIfItIsCalledSo) {
  EXPECT_EQ(say("Is there a table?").reply->verdict, Verdict::yes);
  EXPECT_FALSE(say("Is there a fridge?").reply);
}

TEST_F(NaturalLanguage, EverEmptyAsksForAllLooks) {
  const Reply ever = *say("Was the table ever completely empty?").reply;
  EXPECT_EQ(ever.verdict, Verdict::no);
  EXPECT_EQ(ever.text, "No: table_1 was not empty in 3 looks, from 08:00 to 10:00.");
  EXPECT_EQ(say("Has the table ever been empty before 8:30?").reply->verdict, Verdict::not_observed);
  EXPECT_TRUE(say("When was the table last empty?").reply->not_known);
  EXPECT_EQ(say("How often was the table empty?").reply->number, 0U);
}

TEST_F(NaturalLanguage, WhatMayHaveHappenedBeforeThePeriodIsNotObserved) {
  // It was seen on the table at 08:00, and on the counter at 09:30.
  EXPECT_EQ(say("Was the red thing moved between 8:10 and 9:40?").reply->verdict, Verdict::yes);
  const Reply late = *say("Was the red thing moved between 9:20 and 9:40?").reply;
  EXPECT_EQ(late.verdict, Verdict::not_observed);
  EXPECT_THAT(late.text, HasSubstr("between 08:00 and 09:30"));
}

TEST_F(NaturalLanguage, BothPlacesHaveSeenIt) {
  EXPECT_EQ(say("What has been on both the table and the counter?").reply->objects, std::vector<Id>{1});
  EXPECT_EQ(say("How many things were on both the counter and the table?").reply->number, 1U);
}

TEST_F(NaturalLanguage, AnObjectIsTheOneThatStoodBesideAnother) {
  const NaturalLanguageAnswer answer = say("Where is the red thing that stood next to the blue one at 8:00?");
  ASSERT_TRUE(answer.reply);
  EXPECT_EQ(answer.reply->objects, std::vector<Id>{1});
  EXPECT_FALSE(say("Where is the spoon that stood next to the blue thing at 8:00?").reply);
}

TEST_F(NaturalLanguage, TwoQuestionsAreBothAnswered) {
  const Reply reply = *say("Is the red thing back where it belongs, and when was it put back?").reply;
  EXPECT_TRUE(reply.verdict);
  EXPECT_THAT(reply.text, HasSubstr("moved from table_1 to counter_1"));
}

TEST_F(NaturalLanguage, APlaceThatAClauseNamesIsWhatItStandsFor) {
  const NaturalLanguageAnswer answer = say("After the red thing left the table, what came to it?");
  ASSERT_TRUE(answer.query);
  EXPECT_EQ(answer.query->argument("place"), "table");
}

TEST_F(NaturalLanguage, NobodyInViewIsNotNobody) {
  const Reply reply = *say("Was anybody in the kitchen?").reply;
  EXPECT_EQ(reply.verdict, Verdict::not_observed);
}

TEST_F(NaturalLanguage, WhatHasGoneHasNoNeighbours) {
  const NaturalLanguageAnswer answer = say("What was next to the tea cup at 09:10?");
  ASSERT_TRUE(answer.reply);
  EXPECT_TRUE(answer.reply->not_known);
  EXPECT_EQ(answer.reply->text, "Not known: the tea cup has gone; where it was: blue object.");
  EXPECT_THAT(answer.reply->objects, testing::IsEmpty());
}

TEST_F(NaturalLanguage, WhereAPlaceIs) {
  const NaturalLanguageAnswer answer = say("Where is the table?");
  EXPECT_EQ(answer.query->text(), "room table");
  EXPECT_EQ(answer.reply->places, std::vector<std::string>{"table_1"});
  EXPECT_THAT(answer.reply->text, HasSubstr("in the map"));
}

TEST_F(NaturalLanguage, APlaceThatNobodyCalledSoIsTakenByItsLastWordAndSaysSo) {
  const NaturalLanguageAnswer answer = say("Is there anything on the couch table?");
  EXPECT_EQ(answer.answer->get<ContentsAnswer>().verdict, Verdict::yes);
  EXPECT_THAT(answer.notes, testing::ElementsAre("no place is called 'couch table'; table_1 is meant"));
}

TEST_F(NaturalLanguage, ThisDrawerIsTheOneThatWasLookedAtLast) {
  const NaturalLanguageAnswer answer = say("What do we keep in this drawer?");
  const auto& kept = answer.answer->get<ContentsHistoryAnswer>();
  ASSERT_EQ(kept.places[0].objects.size(), 1U);
  EXPECT_EQ(kept.places[0].objects[0].now.object.id, 4);
  EXPECT_TRUE(kept.places[0].objects[0].still_there);
}

TEST_F(NaturalLanguage, AnAnswerThatDoesNotExistSaysWhy) {
  EXPECT_EQ(say("Is there any cereal on the table?").why_not->reason, "never_seen");
  EXPECT_EQ(say("Do we have milk in the fridge?").why_not->reason, "unknown_place");
  EXPECT_EQ(say("Where was the yellow thing at 9:00?").why_not->reason, "not_yet_seen");
  EXPECT_EQ(say("Where is the red cup '; DROP TABLE object;--").why_not->reason, "not_understood");
  EXPECT_EQ(say("Was the red thing on the table between ten and nine?").why_not->reason, "not_possible");
  const NaturalLanguageAnswer strange = say("Sing a song");
  EXPECT_EQ(strange.why_not->reason, "not_understood");
  EXPECT_EQ(strange.nearest.size(), 3U);
  EXPECT_FALSE(to_json(strange)["understood"].get<bool>());
}

TEST_F(NaturalLanguage, ContentsKnowWhetherThereIsAny) {
  const auto verdict = [&](const char* sentence) {
    return say(sentence).answer->get<ContentsAnswer>().verdict;
  };
  EXPECT_EQ(verdict("Is there a blue thing on the table?"), Verdict::yes);
  EXPECT_EQ(verdict("Is there a green thing on the table?"), Verdict::no);
  EXPECT_EQ(verdict("Is there a red thing in the drawer?"), Verdict::not_observed);
}

TEST_F(NaturalLanguage, ThereIsThePlaceThatWasSpokenOfElseWhereTheThingIs) {
  const auto place = [&](const NaturalLanguageAnswer& answer) {
    return answer.answer->get<WasAnswer>().place;
  };
  EXPECT_EQ(place(say("Was the red thing there between nine and ten?")), "counter_1");
  const auto answers =
      ask(*store_, NaturalLanguageQuestion{
                       {"What is on the table?", "Was the red thing there between eight and nine?"}, {}});
  EXPECT_EQ(place(answers[1]), "table");
  EXPECT_EQ(answers[1].answer->get<WasAnswer>().verdict, Verdict::yes);
}

TEST_F(NaturalLanguage, OfWordsThatAreHalfKnownTheKnownHalfIsHelp) {
  EXPECT_EQ(say("Where is the red teapot?").why_not->hint, "red: object_1");
  EXPECT_EQ(say("Where is the teapot?").why_not->hint.find("object_"), std::string::npos);
}

TEST_F(NaturalLanguage, UsualPlacesCountTheSightings) {
  const auto usual = say("Where is the red thing usually?").answer->get<UsualAnswer>();
  const auto& places = usual.objects.at(0).places;
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].place.name, "counter_1");
  EXPECT_EQ(places[0].sightings, 2U);
  EXPECT_EQ(places[0].by_hour, (std::map<int, size_t>{{9, 1}, {10, 1}}));
  EXPECT_EQ(places[0].by_weekday, (std::map<int, size_t>{{4, 2}}));
  EXPECT_NEAR(places[1].share, 1 / 3.0, 1e-12);
}

TEST_F(NaturalLanguage, UsualPlacesCanBeAskedForAnHourOrADayOfTheWeek) {
  const auto at_nine = say("Where is the red thing usually at nine?").answer->get<UsualAnswer>();
  for (const UsualPlace& place : at_nine.objects.at(0).places)
    EXPECT_EQ(place.by_hour, (std::map<int, size_t>{{9, place.sightings}}));
  EXPECT_FALSE(at_nine.objects.at(0).places.empty());
  const auto fridays = say("Where is the red thing usually on Fridays?").answer->get<UsualAnswer>();
  EXPECT_EQ(fridays.objects.at(0).places.size(), 2U);
  const auto weekend = say("Where is the red thing usually on Sundays?").answer->get<UsualAnswer>();
  EXPECT_TRUE(weekend.objects.at(0).places.empty());
}

TEST_F(NaturalLanguage, TasksNameObjectsTargetsAndWhatIsMissing) {
  const auto task = [&](const char* sentence) { return say(sentence).answer->get<TaskAnswer>(); };
  EXPECT_EQ(task("Bring me my tea cup.").items.at(0).object.object.id, 1);
  const TaskAnswer stow = task("Put the blue thing into drawer_1");
  EXPECT_EQ(stow.items.at(0).target->place.name, "drawer_1_bottom");
  EXPECT_FALSE(stow.items.at(0).done);
  const TaskAnswer fridge = task("Put all perishable items in the fridge.");
  EXPECT_TRUE(fridge.items.empty());
  EXPECT_EQ(fridge.missing.size(), 2U);
  // Red and blue stood on the table at eight; red is on the counter now.
  const TaskAnswer set = task("Set the table for breakfast.");
  ASSERT_EQ(set.items.size(), 2U);
  EXPECT_FALSE(set.items[0].done);
  EXPECT_TRUE(set.items[1].done);
  EXPECT_TRUE(task("Clean up the kitchen.").items.empty());
  const TaskAnswer clear = task("Clear the counter");
  ASSERT_EQ(clear.items.size(), 2U);
  EXPECT_EQ(clear.items[0].target->place.name, "table_1");
  EXPECT_FALSE(clear.items[1].target);
  EXPECT_THAT(clear.missing, testing::ElementsAre(HasSubstr("seen at no other place")));
}

/// The replies of the synthetic day, by sentence.
TEST_F(NaturalLanguage, TheReplyAnswersWhatWasAsked) {
  const std::vector<std::pair<const char*, const char*>> replies = {
      {"Where is the red thing?", "The tea cup is on counter_1."},
      {"Is the red thing on the counter?", "Yes: the tea cup is on counter_1."},
      {"Is the red thing on the table?", "No: the tea cup is on counter_1."},
      {"Is the counter free?", "No: the tea cup and the green object are on counter_1."},
      {"How many things are on the counter?", "2 on counter_1: the tea cup and the green object."},
      {"What is in the first drawer?", "The yellow object is in drawer_1."},
      {"When was the drawer opened?", "By 10:30: drawer_1 opened."},
      {"When did the red thing leave the table?",
       "Between 08:00 and 09:30: the tea cup moved from table_1 to counter_1."},
      {"How sure are you that the red thing is on the counter?", "98 %: the tea cup is on counter_1."},
      {"Why is the red thing on the counter?", "Because the tea cup was last seen on counter_1 at 10:30."},
      {"Who moved the red thing?",
       "Not known who: people are not recognised; the tea cup moved from table_1 to counter_1 by 09:30."},
      {"What colour is the tea cup?", "The tea cup is red."},
      {"Do the tea cup and the green thing have the same colour?",
       "No: the tea cup is red and the green object is green."},
      {"How long was the red thing on the counter?",
       "At least 1 h 0 min: the tea cup was seen on counter_1 from 09:30 to 10:30."},
      {"What has been on the table the longest?", "The blue object: 2 h 30 min, from 08:00 to 10:30."},
      {"Where is everything?", "4 objects: 2 on counter_1, 1 on table_1 and 1 in drawer_1."},
      {"Which place has the most objects?", "Counter_1: 2 objects."},
      {"How often did you look at the counter?", "3 looks at counter_1, the last at 10:30."},
      {"How long has the drawer been empty?", "Not now: the yellow object is in drawer_1."},
      {"How long has the drawer been closed?", "Not known: it was not seen to close."},
      {"How many objects do you know?", "4: tea cup, blue object, green object and yellow object."},
      {"How often did the red thing move?",
       "1 time, the last by 09:30: the tea cup moved from table_1 to counter_1."},
      {"Why is the red thing not on the table?", "Because the tea cup was last seen on counter_1 at 10:30."},
      {"Why is the red thing not on the counter?", "But the tea cup is on counter_1."},
      {"Where was the blue thing before?", "Not known: the blue object was seen nowhere before that."},
      {"What happened?",
       "New: yellow object, green object and 2 more; opened or closed: drawer_1; hidden: blue object; moved: "
       "tea cup."},
      {"What happened at 8:45?", "Not observed: nobody looked then."},
      {"What changed between 8:40 and 8:50?", "Not observed: nobody looked then."},
      {"What was taken from the drawer between 8 and 9?",
       "Not observed: nobody looked into the drawer then."},
      {"What was moved more than once?", "None known: nothing of the kind was seen 2 times then."},
      {"Was the blue thing on the table at 9?", "Yes: the blue object was on table, seen at 09:00."},
      {"Was the blue thing on the counter at 9?",
       "No: the blue object was not on counter: it was seen elsewhere."},
  };
  for (const auto& [sentence, reply] : replies) {
    const NaturalLanguageAnswer answer = say(sentence);
    ASSERT_TRUE(answer.reply) << sentence;
    EXPECT_EQ(answer.reply->text, reply) << sentence;
  }
}

TEST_F(NaturalLanguage, WhoMovedFurnitureIsNotWhoOpenedIt) {
  const NaturalLanguageAnswer answer = say("Who moved the table?");
  EXPECT_EQ(answer.query->text(), "changes --kind place_handled --place table");
  EXPECT_EQ(answer.reply->text, "Not known: no change was seen.");
}

TEST_F(NaturalLanguage, WhoMovedItNamesTheLastSceneWithAPerson) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    const int64_t run = store.begin_run("loci-perceive run", "{}");
    for (const auto& [clock, type] : {std::pair("08:45", "loci.annotation.PersonAnnotation"),
                                      {"09:15", "loci.annotation.PersonAnnotation"},
                                      {"09:20", "loci.annotation.ColorAnnotation"}}) {
      SceneTransaction scene(store, run);
      const Id id = scene.add_scene({.time = testing_support::day_time(clock)});
      scene.add_annotation({.scene = id, .type = type, .value = "person"});
      scene.commit();
    }
    store.finish_run(run);
  }
  store_.emplace(Store::open_read(file_));
  EXPECT_EQ(say("Who moved the red thing?").reply->evidence.at(0), "somebody was in view at 09:15");
  EXPECT_EQ(say("Was anybody in the kitchen before nine?").reply->text,
            "Yes: somebody was in view at 08:45.");
  EXPECT_EQ(say("When was somebody here last?").reply->text, "At 09:15: somebody was in view then.");
  EXPECT_EQ(say("How often was somebody here?").reply->number, 2U);
  const TimeNs from = testing_support::day_time("08:00"), to = testing_support::day_time("09:00");
  EXPECT_EQ(store_->last_annotated("loci.annotation.PersonAnnotation", from, to),
            testing_support::day_time("08:45"));
  EXPECT_FALSE(store_->last_annotated("loci.annotation.ClassAnnotation", from, to));
}

TEST_F(NaturalLanguage, NamesOfSeveralWordsAndPluralsReadWell) {
  EXPECT_THAT(say("Where is the kitchen roll?").why_not->text, HasSubstr("'kitchen roll'"));
  EXPECT_THAT(say("Where is the red corkscrew?").why_not->text, HasSubstr("'corkscrew'"));
  store_.reset();
  {
    Store store = Store::open_write(file_);
    set_fact(store, "object_3", "alias", "tomatoes");
  }
  store_.emplace(Store::open_read(file_));
  EXPECT_EQ(say("Where are the tomatoes?").reply->text, "The tomatoes are on counter_1.");
  EXPECT_THAT(say("Were the tomatoes on the counter at 8:30?").reply->text, HasSubstr("tomatoes were on"));
}

TEST_F(NaturalLanguage, ANameWithAPronounMeansWhoeverWasGivenIt) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    set_fact(store, "object_2", "alias", "my cup");
    set_fact(store, "table_1", "alias", "our table");
  }
  store_.emplace(Store::open_read(file_));
  const auto found = [&](const char* sentence) {
    const NaturalLanguageAnswer answer = say(sentence);
    std::vector<Id> ids;
    if (!answer.answer) {
      ADD_FAILURE() << sentence << "\n" << text(answer);
      return ids;
    }
    for (const auto& location : answer.answer->get<WhereAnswer>().objects) ids.push_back(location.object.id);
    return ids;
  };
  EXPECT_THAT(found("Where is my cup?"), testing::ElementsAre(2));
  EXPECT_THAT(found("where did I leave My  Cup"), testing::ElementsAre(2));
  EXPECT_THAT(say("Where is my cup?").reply->text, testing::StartsWith("My cup is "));
  EXPECT_THAT(found("Where is my tea cup?"), testing::ElementsAre(1));
  EXPECT_THAT(ask(*store_, WhereQuestion{"my cup"}).objects, testing::SizeIs(1));
  EXPECT_EQ(say("What is on our table?").answer->get<ContentsAnswer>().places.at(0).place.name, "table_1");
}

TEST_F(NaturalLanguage, NoLongerIsTheOppositeAndALookHasAnAge) {
  EXPECT_EQ(say("Is the red thing no longer on the table?").reply->text, "Yes: the tea cup is on counter_1.");
  EXPECT_EQ(say("Is the red thing no longer on the counter?").reply->verdict, Verdict::no);
  const NaturalLanguageAnswer look = say("How long ago did you last look at the table?");
  EXPECT_EQ(look.reply->text, "30 min ago, at 10:00: table_1 was last looked at then.");
  EXPECT_EQ(look.reply->duration, 30 * 60 * kSecond);
  const NaturalLanguageAnswer late = say("What moved since nine in the evening?");
  EXPECT_EQ(late.reply->text, "Not observed: the last look was at 10:30.");
  EXPECT_TRUE(late.reply->not_known);
}

TEST_F(NaturalLanguage, SentencesLeanOnTheOneBefore) {
  const auto last = [&](const std::vector<std::string>& sentences) {
    return ask(*store_, NaturalLanguageQuestion{sentences, {}}).back();
  };
  EXPECT_EQ(last({"What is on the table?", "And on the counter?"}).query->text(), "on counter");
  EXPECT_EQ(last({"Where is the red thing?", "And the green thing?"}).query->text(), "where 'green thing'");
  EXPECT_THAT(last({"Is the red thing on the counter?", "Why?"}).reply->text,
              testing::StartsWith("Because the tea cup"));
  EXPECT_EQ(last({"Where is the red thing?", "How sure are you?"}).reply->probability, 0.98);
  EXPECT_EQ(last({"Is the red thing on the counter?", "Since when?"}).reply->time->first,
            testing_support::day_time("09:30"));
  EXPECT_EQ(last({"Was the drawer opened?", "How often?"}).reply->number, 1U);
  EXPECT_EQ(last({"Is the red thing on the counter?", "What else is on the counter?"}).reply->objects,
            std::vector<Id>{3});
  EXPECT_EQ(last({"When was the drawer opened?", "Is it open?"}).query->text(), "opens drawer");
  EXPECT_FALSE(say("And on the counter?").query);
}

TEST_F(NaturalLanguage, OneTypoInANameOrAWordIsReadOver) {
  const NaturalLanguageAnswer name = say("Where is the geen thing?");
  EXPECT_EQ(name.reply->objects, std::vector<Id>{3});
  EXPECT_THAT(name.notes, testing::Contains("'geen' is taken as 'green'"));
  EXPECT_EQ(say("Wher is the green thing?").reply->objects, std::vector<Id>{3});
  const NaturalLanguageAnswer two = say("Where is the gren thgin?");
  EXPECT_EQ(two.reply->objects, std::vector<Id>{3}) << text(two);
  EXPECT_THAT(two.notes, testing::Contains("'gren' is taken as 'green'"));
}

TEST_F(NaturalLanguage, WhatStandsOnAnObjectIsNotWhatStandsOnItsPlace) {
  const NaturalLanguageAnswer answer = say("What is on the blue thing?");
  EXPECT_EQ(answer.query->text(), "near 'blue thing' --relation on");
  EXPECT_EQ(answer.reply->text, "Nothing is on the blue object.");
}

TEST_F(NaturalLanguage, TheWordsOfAPlaceMayComeInAnyOrder) {
  {
    Store store = Store::open_write(file_, {});
    set_fact(store, "counter_1", kPlaceNameKey, "counter_south");
  }
  EXPECT_EQ(say("Is the tea cup on the south counter?").reply->verdict, Verdict::yes);
  EXPECT_EQ(say("What is on the southern counter?").query->argument("place"), "southern counter");
  EXPECT_EQ(say("Is the tea cup on the north counter?").why_not->reason, "unknown_place");
}

TEST_F(NaturalLanguage, AColourThatIsLikeAnotherIsItsOnlyObject) {
  {
    Store store = Store::open_write(file_, {});
    set_fact(store, "blue", "class", "bowl");
  }
  const NaturalLanguageAnswer answer = say("Where is the cyan bowl?");
  ASSERT_TRUE(answer.reply) << text(answer);
  EXPECT_EQ(answer.reply->objects, std::vector<Id>{2});
  EXPECT_THAT(answer.notes, testing::Contains("nothing is called 'cyan bowl'; 'blue bowl' is meant"));
  EXPECT_FALSE(say("Where is the red bowl?").reply);
}

TEST_F(NaturalLanguage, AnUnknownPackageIsTheOnlyNamelessObjectOfItsColour) {
  EXPECT_EQ(say("Where is the green box?").reply->objects, std::vector<Id>{3});
  EXPECT_FALSE(say("Where is the green bicycle?").reply);
}

TEST_F(NaturalLanguage, ANegationIsNotPassedOver) {
  EXPECT_EQ(say("Please confirm that the drawer was not opened.").reply->verdict, Verdict::no);
  EXPECT_EQ(say("Has the tea cup stayed put all day?").reply->verdict, Verdict::no);
  EXPECT_FALSE(say("Which items never changed their surface?").reply);
}

TEST_F(NaturalLanguage, WhatLastedIsAnsweredByAllLooks) {
  const auto verdict = [&](const char* sentence) { return say(sentence).reply->verdict; };
  EXPECT_EQ(verdict("Has the tea cup been on the counter since 8:00?"), Verdict::no);
  EXPECT_EQ(verdict("Has the tea cup been on the counter since 9:30?"), Verdict::yes);
  EXPECT_EQ(verdict("Did the tea cup stay on the table?"), Verdict::no);
  EXPECT_EQ(verdict("Did the green box stay on the counter?"), Verdict::yes);
  EXPECT_EQ(verdict("Was the tea cup on the table until 8:30?"), Verdict::not_observed) << "gone by 9:00";
  EXPECT_EQ(verdict("Was the tea cup on the table from 8:00 to 9:30?"), Verdict::no);
  EXPECT_EQ(verdict("Was the tea cup on the table between 8:00 and 9:30?"), Verdict::yes);
  EXPECT_THAT(say("Did the tea cup stay on the table?").reply->text, HasSubstr("at counter_1 from 09:30"));
}

TEST_F(NaturalLanguage, TogetherIsAtOnePlaceAtOneTime) {
  EXPECT_EQ(say("Were the tea cup and the green box ever on the counter together?").reply->verdict,
            Verdict::yes);
  EXPECT_EQ(say("Were the tea cup and the green box ever on the table at the same time?").reply->verdict,
            Verdict::not_observed);
  const NaturalLanguageAnswer answer = say("What was on the table together with the tea cup?");
  ASSERT_TRUE(answer.reply) << text(answer);
  EXPECT_THAT(answer.reply->objects, testing::Contains(2));
}

TEST_F(NaturalLanguage, WhatWasNeverThereIsNotWhatNeverLeft) {
  EXPECT_THAT(say("Which objects were never on the table?").reply->objects,
              testing::UnorderedElementsAre(3, 4));
  EXPECT_THAT(say("What was not on the table at 9:40?").reply->objects, testing::UnorderedElementsAre(1, 3));
}

TEST_F(NaturalLanguage, AMomentIsNoPeriodWithoutALook) {
  EXPECT_EQ(say("What was gone at 9:10?").reply->objects, std::vector<Id>{1});
  EXPECT_EQ(say("Was the tea cup gone at 9:10?").reply->verdict, Verdict::yes);
  EXPECT_EQ(say("Was the tea cup gone at 8:10?").reply->verdict, Verdict::no);
}

TEST_F(NaturalLanguage, AQuestionWordAloneAsksMoreOfWhatWasAsked) {
  const auto after = [&](const char* question, const char* follow_up) {
    return ask(*store_, NaturalLanguageQuestion{{question, follow_up}, {}}).at(1);
  };
  EXPECT_TRUE(after("Was the tea cup on the counter?", "When?").reply->time);
  EXPECT_TRUE(after("Was the tea cup on the counter?", "How long?").reply->duration);
  EXPECT_TRUE(after("Was the tea cup on the counter?", "Since when?").reply->time);
  EXPECT_TRUE(after("Was the tea cup in the drawer?", "Why not?").reply);
}

TEST_F(NaturalLanguage, WhatRestrictsBesideAQuestionIsNotPassedOver) {
  EXPECT_FALSE(say("How many things are there altogether, red thing?").reply);
  EXPECT_FALSE(say("I need the tea cup that is not on the table, where is it?").reply);
  EXPECT_FALSE(say("Which of these is the biggest?").reply) << "of what?";
  EXPECT_THAT(say("The tea cup was on the table. Which one was moved?").query->text(), HasSubstr("tea cup"));
}

TEST_F(NaturalLanguage, BeforeTheFirstLookNothingWasObserved) {
  const NaturalLanguageAnswer answer = say("Was the tea cup on the table before 7:00?");
  EXPECT_EQ(answer.reply->text, "Not observed: the first look was at 08:00.");
  EXPECT_EQ(answer.reply->verdict, Verdict::not_observed);
}

TEST_F(NaturalLanguage, WhatWasLookedForAndNotFoundWasNotSeen) {
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec("UPDATE visibility SET status = 'missed' WHERE object = 2 AND scene = 5");
  const NaturalLanguageAnswer answer = say("Have you seen the blue thing after 9:30?");
  EXPECT_EQ(answer.reply->verdict, Verdict::no) << text(answer);
}

TEST_F(NaturalLanguage, WhatTheLastLookMissedIsCountedAsProbable) {
  store_.reset();
  {
    Store store = Store::open_write(file_, {});
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    const Id id = scene.add_scene({.time = testing_support::day_time("11:00")});
    scene.add_visibility({.scene = id, .object = 2, .status = ObjectStatus::missed, .probability = 0.9});
    scene.add_belief({.object = 2,
                      .scene = id,
                      .status = ObjectStatus::missed,
                      .probability = 0.65,
                      .place = store.places().at(0).id,
                      .position = Vector3d(0.7, 0.5, 0.8),
                      .last_scene = 3,
                      .color = "blue"});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  EXPECT_EQ(say("How many blue things are there?").reply->text,
            "Probably 1: blue object, not seen at the last look.");
  EXPECT_EQ(say("How many objects are gone?").reply->number, 0U);
  EXPECT_EQ(say("Is the blue thing on the table?").reply->text,
            "Not observed: the blue object is probably on table_1, but was not seen at the last look.");
}

TEST_F(NaturalLanguage, HowLongItIsGoneLiesBetweenTheLooks) {
  const Query query{
      .question = "where", .arguments = {{"object", "red"}, {"at", "09:10"}}, .asks = Asks::duration};
  const AsOf then = at("09:10");
  const Reply reply = ask(*store_, query).reply({*store_, query, then, TimeWriter(*store_)});
  EXPECT_EQ(reply.text, "At most 1 h 0 min: the tea cup was last seen at 08:00, and not at 09:00.");
}

TEST_F(NaturalLanguage, WhatLeftBeforeTheNextLookWasProbablyThere) {
  EXPECT_EQ(say("Where was the red thing at 8:30?").reply->text,
            "The tea cup was probably on table_1; it left between 08:00 and 09:00.");
}

TEST_F(NaturalLanguage, WhatTheLastLookMissedIsNotElsewhere) {
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec(
          "INSERT INTO visibility (scene, object, status, valid_from, known_from, run) "
          "SELECT id, 2, 'missed', time, 0, 1 FROM scene WHERE id = 6");
  const NaturalLanguageAnswer answer = say("Is the blue thing on the table?");
  EXPECT_EQ(answer.reply->verdict, Verdict::yes) << text(answer);
  EXPECT_THAT(answer.reply->text, HasSubstr("on table_1, but was not seen at the last look"));
}

TEST_F(NaturalLanguage, SoundsAndPlansSayNothing) {
  const auto command = [&](const char* sentence) {
    const NaturalLanguageAnswer answer = say(sentence);
    return answer.query ? answer.query->text() : "";
  };
  EXPECT_EQ(command("Before I start the dishwasher - where is the tea cup?"), "where 'tea cup'");
  EXPECT_EQ(command("before I wash the plates, how many things are on the counter?"), "on counter");
  EXPECT_FALSE(say("Before I put the tea cup on the counter, where was the plate?").reply)
      << "it was put there";
  EXPECT_TRUE(say("and uh how long was the tea cup away from the table").reply->duration);
  EXPECT_EQ(command("um where's the, uh, tea cup"), "where 'tea cup'");
}

TEST_F(NaturalLanguage, ATranscriptSeparatesNoSentences) {
  EXPECT_EQ(say("so i'm standing in front of the counter what's on it").query->text(), "on counter");
  EXPECT_EQ(say("i laid everything out at eight what's missing from the table now").query->text(),
            "contents-history table --from eight --state gone");
  EXPECT_EQ(say("I laid the table at eight. What is missing?").query->text(),
            "objects --from eight --state gone");
}

TEST_F(NaturalLanguage, HowSureIsAskedOfANo) {
  const auto last = [&](const std::vector<std::string>& sentences) {
    return ask(*store_, NaturalLanguageQuestion{sentences, {}}).back();
  };
  const NaturalLanguageAnswer answer = last({"Is the tea cup on the table?", "How certain is that?"});
  ASSERT_TRUE(answer.reply->probability);
  EXPECT_GT(*answer.reply->probability, 0.9) << "that it is elsewhere";
  const NaturalLanguageAnswer there = say("How probable is it that the tea cup is still on the table?");
  ASSERT_TRUE(there.reply->probability);
  EXPECT_LT(*there.reply->probability, 0.1);
}

TEST_F(NaturalLanguage, HowLongAgoThatWas) {
  const auto answers = ask(
      *store_,
      NaturalLanguageQuestion{{"When did you last see the blue thing?", "And how long ago was that?"}, {}});
  ASSERT_TRUE(answers[1].reply);
  EXPECT_TRUE(answers[1].reply->duration) << text(answers[1]);
}

TEST_F(NaturalLanguage, WhyIsNoMatterOfLooks) {
  const NaturalLanguageAnswer answer = say("Why would anybody move the tea cup?");
  EXPECT_THAT(answer.reply->text, testing::StartsWith("Not known why"));
  EXPECT_TRUE(answer.reply->not_known);
}

TEST_F(NaturalLanguage, AClauseSaysMoreOfAGivenTime) {
  const NaturalLanguageAnswer answer = say("Was there anything in the drawer at 10:30, when it stood open?");
  EXPECT_EQ(answer.query->text(), "in drawer --at 10:30");
  EXPECT_EQ(answer.reply->verdict, Verdict::yes);
}

TEST_F(NaturalLanguage, FurnitureByItsNameHasASize) {
  EXPECT_EQ(say("How high is counter_1?").query->text(), "room counter_1");
}

TEST_F(NaturalLanguage, TheBiggestOfAPeriodIsOneThatWasThere) {
  const NaturalLanguageAnswer answer = say("What was the biggest object on the table today?");
  ASSERT_TRUE(answer.reply) << text(answer);
  EXPECT_EQ(answer.reply->objects.size(), 1U);
  EXPECT_EQ(answer.query->question, "contents-history");
}

TEST_F(NaturalLanguage, TheLastLookIsWhatWasSeenLast) {
  const NaturalLanguageAnswer answer = say("What did you see last?");
  ASSERT_TRUE(answer.reply) << text(answer);
  EXPECT_THAT(answer.reply->objects, testing::Contains(4));
  const std::string last = format_time(testing_support::day_time("10:30"));
  EXPECT_EQ(answer.query->argument("from"), last) << "the visit, not a fixed time before";
  EXPECT_EQ(answer.query->argument("to"), last);
  EXPECT_EQ(say("What did you see in the last look?").reply->objects, answer.reply->objects);
}

}  // namespace
}  // namespace loci::memory
