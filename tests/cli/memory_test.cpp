#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "mapping/base/output_file.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/memory/questions/synthetic_day.h"

namespace loci::apps::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class MemoryCli : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    file_ = folder_ + "/day.loci";
    const memory::testing_support::SyntheticDay day(file_);
  }
  Outcome ask(const std::string& arguments) const { return run("loci-memory " + arguments + " -m " + file_); }
  std::string folder_, file_;
};

TEST_F(MemoryCli, AnswersEveryQuestionInWordsAndAsJson) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"where red --details", "tea cup (object_1, red"},
      {"where tea cup --at 08:10 --details", "on table_1"},
      {"history red --details", "from 09:30 to 10:30, on counter_1"},
      {"on table_1 --details", "1 object is on table_1"},
      {"in drawer_1 --details", "in drawer_1_bottom"},
      {"was red on table_1 --between 07:50 08:10 --details", "Yes: tea cup (object_1"},
      {"was red on table_1 --between 08:50 09:10 --details", "No: tea cup (object_1"},
      {"was red on table_1 --between 11:00 12:00 --details",
       "Not observed: nobody saw whether tea cup (object_1"},
      {"changes --between 08:50 09:10 --details", "has gone from table_1"},
      {"objects", "object_4"},
      {"scenes --from 10:00", "scene 5, frame 4 of day"},
      {"timeline --to 08:00", "appeared on table_1"},
      {"verify", "The memory is sound"}};
  for (const auto& [question, expected] : cases) {
    const Outcome words = ask(question);
    EXPECT_EQ(words.exit_code, 0) << question << ": " << words.error;
    EXPECT_THAT(words.out, HasSubstr(expected)) << question;
    EXPECT_EQ(words.error, "") << question;
    EXPECT_TRUE(parse_json(ask(question + " --json").out, question).is_object());
  }
}

TEST_F(MemoryCli, ASentenceNeedsNoQuotes) {
  EXPECT_EQ(ask("ask where is the tea cup").out, ask("ask 'where is the tea cup'").out);
  EXPECT_THAT(ask("ask where is the tea cup").out, StartsWith("The tea cup is"));
}

TEST_F(MemoryCli, WithoutTokensNothingIsProven) {
  const std::string tokens = folder_ + "/tokens.json";
  write_output(
      tokens,
      R"({"loci_forgotten": {"version": 1, "texts": [], "hashes": [], "numbers": [], "images": []}})");
  const Outcome outcome = ask("verify --forgotten " + tokens);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("tokens.json: there are no tokens: nothing can be proven; "));
}

TEST_F(MemoryCli, APointIsCalledByItsCoordinates) {
  EXPECT_EQ(ask("near 71,2").out, "Nothing is within 50 cm of (71.00, 2.00).\n");
}

TEST_F(MemoryCli, ForgettingANameIsAnsweredWithTheNumberThatItMeans) {
  const Outcome outcome = ask("forget 'tea cup'");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error,
            "loci-memory forget: 'tea cup' is neither an object, as object_12, nor a place; give its "
            "number: object_1\n");
}

TEST_F(MemoryCli, AnswersFirstInOneSentenceWithAtMostThreeLinesOfEvidence) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"where red", "The tea cup is on counter_1."},
      {"history red", "The tea cup was on table_1 and on counter_1."},
      {"on table_1", "The blue object is on table_1."},
      {"was red on table_1 --between 07:50 08:10", "Yes: the tea cup was on table_1"},
      {"was red on table_1 --between 08:50 09:10", "No: the tea cup was not on table_1"},
      {"was red on table_1 --between 11:00 12:00", "Not observed"}};
  for (const auto& [question, expected] : cases) {
    const std::string text = ask(question).out;
    EXPECT_THAT(text, testing::StartsWith(expected)) << question;
    EXPECT_LE(lines_of(text), 4) << text;
    EXPECT_THAT(ask(question + " --details").out, testing::StartsWith(expected)) << question;
  }
}

TEST_F(MemoryCli, QuestionsThatInspectAnswerInOneSentenceAndListTenLinesUnlessAllAreAskedFor) {
  const std::string memory = folder_ + "/many.loci";
  ASSERT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + memory).exit_code, 0);
  const auto text = [&](const std::string& question) {
    const Outcome outcome = run("loci-memory " + question + " -m " + memory);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome.out;
  };
  const std::string brief = text("scenes"), all = text("scenes --details");
  EXPECT_THAT(brief, testing::EndsWith("... 2 more lines with --details\n")) << brief;
  EXPECT_EQ(lines_of(all), lines_of(brief) + 1) << all;
  EXPECT_THAT(all, HasSubstr("scene 12"));
  EXPECT_EQ(text("scenes --json"), text("scenes --details --json"));
  const std::string objects = text("objects");
  EXPECT_THAT(objects, StartsWith("2 of 4 are likely where they were seen last: mug and milk.\n"))
      << "the answer first";
  EXPECT_THAT(objects, HasSubstr("object_4"));
  EXPECT_EQ(objects, text("objects --details")) << "short enough";
}

TEST_F(MemoryCli, UnknownThingsAndTimesAreOneLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"where purple", "nothing is known as 'purple'"},
      {"where bleu", "did you mean 'blue'?"},
      {"on tabel_1", "did you mean 'table_1'?"},
      {"where red --at soon", "'soon' is not a time"},
      {"was red on table_1 --between 09:00 08:00", "first time is after the second"},
      {"where object_77", "nothing is known as 'object_77'"}};
  for (const auto& [question, expected] : cases) {
    const Outcome outcome = ask(question);
    EXPECT_EQ(outcome.exit_code, 1) << question;
    EXPECT_EQ(outcome.out, "") << question;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr(expected));
  }
}

TEST_F(MemoryCli, BadFilesAreOneLine) {
  write_file_atomically(folder_ + "/text.loci", "this is no database, only a text of some length");
  write_file_atomically(folder_ + "/short.loci", std::string_view(read_file(file_)).substr(0, 20000));
  write_file_atomically(folder_ + "/empty.loci", "");
  for (const char* name : {"text.loci", "short.loci", "empty.loci", "missing.loci", ""})
    for (const char* command : {"where red", "objects", "verify"}) {
      const Outcome outcome = run(std::string("loci-memory ") + command + " -m " + folder_ + "/" + name);
      EXPECT_EQ(outcome.exit_code, 1) << name;
      EXPECT_EQ(outcome.out, "") << name;
      EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    }
}

TEST(ResolveCli, PrintsTheAnswerAsJson) {
  const Outcome outcome = run("loci-memory resolve tests/data/identity/two_by_two.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json answer = parse_json(outcome.out, "stdout");
  for (const char* key : {"stay", "move", "newview", "not", "appear", "clutter", "disappear", "missed",
                          "hidden", "log_z", "map", "best"})
    EXPECT_TRUE(answer.contains(key)) << key;
  EXPECT_NEAR(answer["log_z"].get<double>(), 4.362153892982137, 1e-9);
}

TEST(ResolveCli, RefusesBadVectorsInOneLine) {
  for (const auto& [file, expected] :
       {std::pair{"reject_nan", "invalid_value"}, {"reject_shape", "invalid_shape"}}) {
    const Outcome outcome = run(std::string("loci-memory resolve tests/data/identity/") + file + ".json");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(lines_of(outcome.error), 1);
    EXPECT_THAT(outcome.error, HasSubstr(expected));
  }
}

}  // namespace
}  // namespace loci::apps::test
