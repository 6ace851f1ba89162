#include <fstream>

#include "apps/evaluate/questions/judge.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::apps::questions {
namespace {

const std::string kTables = LOCI_SOURCE_DIR "/tests/data/questions/";

std::vector<AskedQuestion> all_questions() {
  return read_table(kTables + "tuning.yaml");
}

/// The questions of the tables, asked of the memory of the synthetic day.
class QuestionTables : public memory::testing_support::DayFixture {
 protected:
  memory::NaturalLanguageAnswer say(const AskedQuestion& asked) const {
    std::vector<std::string> sentences = asked.after;
    sentences.push_back(asked.sentence);
    return ask(*store_, memory::NaturalLanguageQuestion{sentences}).back();
  }
};

TEST_F(QuestionTables, EveryAnswerIsOneShortSentenceAndAtMostThreeLinesOfEvidence) {
  const memory::TimeWriter times(*store_);
  for (const AskedQuestion& asked : all_questions()) {
    const memory::NaturalLanguageAnswer answer = say(asked);
    const std::string text = to_text(answer, times);
    const std::string first = text.substr(0, text.find('\n'));
    EXPECT_LE(first.size(), memory::kMaxReplyLength) << asked.sentence << "\n" << text;
    EXPECT_FALSE(first.empty()) << asked.sentence;
    if (answer.query) {
      EXPECT_LE(std::ranges::count(text, '\n'), 1 + static_cast<std::ptrdiff_t>(memory::kMaxEvidenceLines))
          << asked.sentence << "\n"
          << text;
    }
  }
}

TEST_F(QuestionTables, AReplyIsOfTheTypeThatWasAskedFor) {
  for (const AskedQuestion& asked : all_questions()) {
    const memory::NaturalLanguageAnswer answer = say(asked);
    if (!answer.reply || answer.reply->not_known) continue;
    const std::string& text = answer.reply->text;
    if (answer.reply->verdict) {
      EXPECT_TRUE(text.starts_with("Yes") || text.starts_with("No")) << asked.sentence << "\n" << text;
    }
    if (answer.query->asks == memory::Asks::number) {
      EXPECT_TRUE(answer.reply->number) << asked.sentence << "\n" << text;
    }
    if (answer.query->asks == memory::Asks::probability) {
      EXPECT_TRUE(answer.reply->probability) << asked.sentence << "\n" << text;
    }
  }
}

TEST_F(QuestionTables, WhatIsNotUnderstoodSaysSoAndNamesWhatIs) {
  size_t count = 0;
  for (const AskedQuestion& asked : all_questions()) {
    const memory::NaturalLanguageAnswer answer = say(asked);
    if (answer.query) continue;
    ++count;
    EXPECT_EQ(answer.why_not->reason, "not_understood") << asked.sentence;
    EXPECT_EQ(answer.nearest.size(), 3U) << asked.sentence;
    EXPECT_FALSE(to_json(answer)["understood"].get<bool>()) << asked.sentence;
    EXPECT_EQ(to_text(answer, memory::TimeWriter(*store_)).find("ever seen"), std::string::npos)
        << asked.sentence;
  }
  EXPECT_GT(count, 5U);
}

TEST_F(QuestionTables, OutcomesTellWrongFromUndecided) {
  const AskedQuestion on_table{
      .memory = "day", .sentence = "Is the red thing on the table?", .verdict = {"yes"}};
  EXPECT_EQ(judge(on_table, *store_, {}).outcome, Outcome::wrong);
  AskedQuestion place{.memory = "day", .sentence = "Where is the red thing?", .place = {"counter_1"}};
  EXPECT_EQ(judge(place, *store_, {{1, "cup"}}).outcome, Outcome::right);
  const AskedQuestion cup{
      .memory = "day", .sentence = "Which red thing is on the counter?", .objects = {{"cup_2"}}};
  EXPECT_EQ(judge(cup, *store_, {{1, "cup_1"}}).outcome, Outcome::wrong);
  EXPECT_EQ(judge(cup, *store_, {{1, "cup_1"}}, {{"cup_1", "cup_1"}, {"cup_2", "cup_1"}}).outcome,
            Outcome::right);
  place.sentence = "How many things are on the counter?";
  EXPECT_EQ(judge(place, *store_, {}).outcome, Outcome::misleading);
  place.sentence = "Sing a song";
  EXPECT_EQ(judge(place, *store_, {}).outcome, Outcome::not_understood);
  place.sentence = "Is anything in the drawer 7?";
  EXPECT_NE(judge(place, *store_, {}).outcome, Outcome::right);
}

TEST(QuestionTable, AnUnknownKeyIsRefused) {
  const TemporaryFolder folder("loci_test");
  const auto file = folder.path() / "table.yaml";
  std::ofstream(file) << "- {memory: day, ask: \"Where is it?\", plcae: table_1}\n";
  EXPECT_THROW(read_table(file), Error);
}

}  // namespace
}  // namespace loci::apps::questions
