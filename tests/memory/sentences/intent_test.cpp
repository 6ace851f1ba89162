#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "memory/questions/facts.h"
#include "memory/sentences/discourse.h"
#include "memory/sentences/intents/intent_model.h"
#include "memory/sentences/natural_language.h"
#include "memory/sentences/sentence_parser.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

Paraphrases few_paraphrases() {
  return read_paraphrases(
      "= Where is OBJECT?\nwhere did i leave OBJECT\nseen OBJECT\n= Is OBJECT on PLACE?\nOBJECT still on "
      "PLACE\n"
      "= none\nis OBJECT fresh\n",
      "few.txt");
}

TEST(Intents, AreTrainedFromParaphrases) {
  const Paraphrases paraphrases = few_paraphrases();
  EXPECT_THAT(paraphrases.forms, ElementsAre("Where is OBJECT?", "Is OBJECT on PLACE?", "none"));
  const IntentModel model = train_intents(paraphrases.forms, paraphrases.samples);
  const IntentModel again = train_intents(paraphrases.forms, paraphrases.samples);
  EXPECT_THAT(model.weights, ElementsAreArray(again.weights));
  EXPECT_THAT(model.signatures, ElementsAre("OBJECT", "OBJECT PLACE", "*"));
  const auto form_of = [&](const Words& words) {
    return model.forms[best_intent(model, intent_tokens(words)).form];
  };
  EXPECT_EQ(form_of({"where", "did", "she", "put", "OBJECT"}), "Where is OBJECT?");
  EXPECT_EQ(form_of({"OBJECT", "on", "PLACE"}), "Is OBJECT on PLACE?");
  EXPECT_EQ(form_of({"is", "OBJECT", "fresh"}), "none");
  EXPECT_THAT(uncovered_words(model, 0, intent_tokens({"where", "else", "is", "OBJECT"})),
              ElementsAre("else"));
}

TEST(Intents, SynonymsOfAParaphraseCount) {
  const Paraphrases paraphrases = read_paraphrases(
      "= Where is OBJECT?\nwho has espied OBJECT\n= Is OBJECT gone?\nhas OBJECT vanished\n", "few.txt");
  const IntentModel model = train_intents(paraphrases.forms, paraphrases.samples);
  const Tokens tokens = intent_tokens({"who", "has", "descried", "OBJECT"});  // a synonym
  EXPECT_EQ(best_intent(model, tokens).form, 0U);
  EXPECT_THAT(uncovered_words(model, 0, tokens), ElementsAre());
  EXPECT_THAT(uncovered_words(model, 0, intent_tokens({"who", "has", "painted", "OBJECT"})),
              ElementsAre("paint"));
}

TEST(Intents, AParaphraseNamesWhatItsFormNames) {
  try {
    read_paraphrases("= Where is OBJECT?\nwhere is it\n", "few.txt");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("few.txt:2"));
  }
}

const TimeReader kNow(parse_time("2026-05-01T10:30:00Z"), TimeZone());

TEST(Intents, EveryFormIsReadByTheGrammar) {
  const std::map<std::string, std::string> names = {
      {"OBJECT", "milk"}, {"OTHER", "jam"}, {"THIRD", "oil"}, {"PLACE", "drawer_1"}, {"SECOND", "table_1"}};
  for (std::string form : trained_intents().forms) {
    if (form == kNoIntent) continue;
    for (const auto& [placeholder, name] : names)
      if (const size_t at = form.find(placeholder); at != std::string::npos)
        form.replace(at, placeholder.size(), name);
    EXPECT_TRUE(parse_sentence(form, kNow)) << form;
  }
}

TEST(SentenceParts, QuestionsStandApartFromStories) {
  const auto parts = [](const char* sentence) {
    std::vector<std::string> asked;
    for (const SentencePart& part : sentence_parts(sentence, kNow))
      asked.push_back((part.asks ? "? " : "") + join_words(part.words, 0, part.words.size()));
    return asked;
  };
  EXPECT_THAT(parts("My aunt came to tea, so where is the jam?"),
              ElementsAre("my aunt came to tea", "? where is the jam"));
  EXPECT_THAT(parts("Is drawer 1 open and what is in it?"),
              ElementsAre("? is drawer 1 open", "? what is in it"));
  EXPECT_THAT(parts("After breakfast, where was the jam?"),
              ElementsAre("? where was the jam after breakfast"));
  EXPECT_THAT(parts("If the drawer is open, where is the jam?"), ElementsAre());
}

class SecondReader : public testing_support::DayFixture {
 protected:
  NaturalLanguageAnswer say(const std::string& sentence) const {
    return ask(*store_, NaturalLanguageQuestion{{sentence}, {}}).at(0);
  }
};

TEST_F(SecondReader, SaysWhatItUnderstood) {
  const NaturalLanguageAnswer answer = say("whatever became of the yellow thing");
  ASSERT_TRUE(answer.query);
  EXPECT_EQ(answer.understood_as, "What happened to the yellow thing?");
  EXPECT_THAT(text(answer), testing::StartsWith("What happened to the yellow thing?\n"));
  EXPECT_EQ(to_json(answer)["understood_as"], "What happened to the yellow thing?");
}

TEST_F(SecondReader, LeavesStoriesOut) {
  EXPECT_EQ(say("My aunt is coming at nine and I want to hide the tea cup, so is it still on the counter?")
                .reply->verdict,
            Verdict::yes);
  EXPECT_EQ(
      say("Nobody here remembers what became of the tea cup after the washing up, when did you see it last?")
          .query->text(),
      "where 'tea cup'");
}

TEST_F(SecondReader, AnswersEachQuestionOfASentence) {
  const NaturalLanguageAnswer answer = say("Where is the tea cup and is the counter empty?");
  EXPECT_EQ(answer.understood_as, "where is the tea cup? is the counter empty?");
  EXPECT_EQ(std::ranges::count(answer.reply->text, '\n'), 1) << text(answer);
  EXPECT_TRUE(answer.reply->verdict) << text(answer);
  EXPECT_EQ(answer.reply->places.front(), "counter_1");
}

TEST_F(SecondReader, AClauseTellsWhichObjectIsMeant) {
  EXPECT_EQ(say("Where is the red thing that stood on the table?").query->text(), "where object_1");
}

TEST_F(SecondReader, AnAttributeInAClauseIsOneBeforeTheName) {
  EXPECT_THAT(say("Tell me everything that is red").reply->objects, ElementsAre(1));
}

TEST_F(SecondReader, OfTwoPlacesTheOneWhereItIsIsNamed) {
  EXPECT_EQ(say("Does the tea cup stand on the table or on the counter?").reply->text,
            "The tea cup is on counter_1.");
}

TEST_F(SecondReader, ComparesObjects) {
  EXPECT_THAT(say("how far apart are the blue thing and the red thing").query->text(),
              HasSubstr("compare 'blue thing' --by distance"));
  EXPECT_TRUE(say("Is the red thing bigger than the blue thing?").reply->verdict);
  EXPECT_THAT(say("Which is bigger, the red thing or the blue thing?").query->text(),
              HasSubstr("--by bigger"));
  EXPECT_EQ(say("Are there more things on the counter than in the drawer?").reply->verdict, Verdict::yes);
}

TEST_F(SecondReader, DoesNotUnderstandWhatTheMemoryCannotKnow) {
  for (const char* sentence :
       {"who is the president", "is the red thing tasty", "what does the red thing cost", "blah blah blah",
        "where was the red thing when my aunt came", "can you open the drawer", "is the counter a mess",
        "will the red thing be on the counter tomorrow", "what should I cook with the red thing",
        "the red thing is nicer than the blue thing", "how do I get to the station",
        "which thing do you like best"}) {
    const NaturalLanguageAnswer answer = say(sentence);
    EXPECT_FALSE(answer.query) << sentence << ": " << text(answer);
  }
}

TEST_F(SecondReader, AnEventIsATime) {
  const NaturalLanguageAnswer answer = say("Where was the blue thing when the red thing left the table?");
  ASSERT_TRUE(answer.query) << text(answer);
  EXPECT_THAT(answer.query->text(), HasSubstr("where 'blue thing' --at 2026-"));
  EXPECT_THAT(answer.notes.front(), HasSubstr("the red thing left the table: "));
  EXPECT_THAT(say("Was the blue thing on the counter before the red thing left the table?").query->text(),
              HasSubstr("--to 2026-"));
}

TEST_F(SecondReader, TopicsOfSeveralAndPlansRestrictNothing) {
  EXPECT_THAT(say("The blue thing and the red thing - how far apart are they?").query->text(),
              HasSubstr("compare 'blue thing' --by distance"));
  EXPECT_EQ(say("Before I go out: is the tea cup still standing on the counter?").reply->verdict,
            Verdict::yes);
  EXPECT_FALSE(say("Before I moved the tea cup: is the blue thing on the counter?").reply);
}

TEST_F(SecondReader, PassesOverNewWordsButNoneThatMeansSomethingElse) {
  EXPECT_EQ(say("Where in blazes is the tea cup?").query->text(), "where 'tea cup'");
  EXPECT_EQ(say("How long has the drawer been shut?").query->asks, Asks::closed_for) << "not open";
  EXPECT_FALSE(say("Where is most of the tea cup?").reply);
  EXPECT_EQ(say("Well I never, whatever became of the yellow thing in the end").query->text(),
            "changes --object 'yellow thing'");
  EXPECT_FALSE(say("What moved the furthest?").reply) << "not what moved";
}

TEST_F(SecondReader, ANameOfTwoObjectsIsAPair) {
  {
    Store store = Store::open_write(file_, {});
    set_fact(store, "blue", "class", "bowl");
    set_fact(store, "object_1", "class", "bowl");
  }
  const NaturalLanguageAnswer answer = say("How far apart are the two bowls?");
  ASSERT_TRUE(answer.query);
  EXPECT_THAT(answer.query->text(), HasSubstr("--by distance"));
}

TEST_F(SecondReader, WhatANameIsForOrInChangesNothing) {
  {
    Store store = Store::open_write(file_, {});
    set_fact(store, "blue", "class", "jam");
    set_fact(store, "object_1", "class", "pot");
  }
  const auto found = [&](const std::string& sentence) {
    const NaturalLanguageAnswer answer = say(sentence);
    EXPECT_TRUE(answer.reply) << text(answer);
    return answer.reply ? answer.reply->objects : std::vector<Id>{};
  };
  EXPECT_EQ(found("Where is the jam jar?"), found("Where is the jam?"));
  EXPECT_EQ(found("Where is the jar of jam?"), found("Where is the jam?"));
  EXPECT_EQ(found("Where is the soup pot?"), found("Where is the pot?"));
  EXPECT_THAT(text(say("Where is the soup pot?")), HasSubstr("'pot' is meant"));
  EXPECT_FALSE(say("Where is the blue pot?").reply);  // the pot is red
  EXPECT_FALSE(say("Where is the flower pot?").reply);
}

TEST_F(SecondReader, SaysWhetherAnObjectIsWhereItUsuallyIs) {
  const NaturalLanguageAnswer answer = say("Is the tea cup where it belongs?");
  EXPECT_EQ(answer.reply->verdict, Verdict::yes) << text(answer);
  EXPECT_THAT(answer.reply->text, HasSubstr("as usual"));
  EXPECT_EQ(say("Where was the tea cup first?").reply->places.front(), "table_1");
  const NaturalLanguageAnswer unmoved = say("What was not moved?");
  EXPECT_FALSE(unmoved.reply->objects.empty()) << text(unmoved);
}

TEST_F(SecondReader, ChoosesAmongMoreThanTwo) {
  EXPECT_EQ(say("Which is the biggest, the red thing, the blue thing or the tea cup?").query->text(),
            "objects 'biggest red thing or blue thing or tea cup'");
}

TEST_F(SecondReader, AWordForKindsNamesWhatItIsTakenFor) {
  {
    Store store = Store::open_write(file_, {});
    set_fact(store, "tea cup", "class", "mug");
  }
  const NaturalLanguageAnswer answer = say("Is there any crockery on the counter?");
  ASSERT_TRUE(answer.reply) << text(answer);
  EXPECT_EQ(answer.reply->verdict, Verdict::yes) << text(answer);
  EXPECT_THAT(text(answer), HasSubstr("'crockery' is taken as mug"));
  EXPECT_THAT(text(say("What is on the worktop?")), HasSubstr("counter_1 is meant"));
}

TEST_F(SecondReader, AnUnknownObjectIsUnknown) {
  const NaturalLanguageAnswer answer = say("My flight leaves at ten, so where on earth is my passport?");
  EXPECT_FALSE(answer.reply) << text(answer);
}

}  // namespace
}  // namespace loci::memory
