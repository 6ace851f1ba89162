#include "memory/questions/question.h"

#include <gmock/gmock.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/questions/contents.h"
#include "memory/questions/replies/reply.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using Declarations = testing_support::DayFixture;

TEST(QuestionDeclarations, HaveUniqueNamesAndExamplesThatParse) {
  for (const Question& question : questions()) {
    EXPECT_EQ(find_question(question.name), &question) << question.name;
    EXPECT_EQ(question.examples.size(), 2U) << question.name;
    for (std::string example : question.examples) {
      if (const size_t json = example.find("--json"); json != std::string::npos) example.resize(json);
      EXPECT_TRUE(parse_query(question.name + " " + example)) << question.name << " " << example;
    }
  }
}

TEST(QuestionDeclarations, AreTheReference) {
  EXPECT_EQ(read_file(LOCI_SOURCE_DIR "/docs/questions.md"), questions_reference())
      << "loci-memory questions > docs/questions.md";
}

TEST(Queries, AreTypedAsTheyAreWritten) {
  for (const char* text : {"where 'tea cup' --at 08:30", "was red on table_1 --between 08:00 09:00",
                           "changes --kind left --place table", "task stow red --destination drawer_1",
                           "task clean", "near 1.0,2.0 --radius '50 cm'", "changes --from nine"})
    EXPECT_EQ(parse_query(text)->text(), text);
  EXPECT_EQ(parse_query("loci-memory was red table_1")->text(), "was red on table_1");
  EXPECT_FALSE(parse_query("sing a song"));
  for (const char* text : {"where", "where red --att nine", "where red --at", "task sing", "scenes red",
                           "like red --image x.png", "changes --kind flown"})
    EXPECT_THROW(parse_query(text), Error) << text;
}

TEST_F(Declarations, SayWhatANameIsTakenFor) {
  const auto reply = [&](const Query& query) {
    const Question& question = *find_question(query.question);
    const Answer answer = question.ask(*store_, query);
    return std::pair(question.reply(*store_, query, answer), answer);
  };
  const std::string note = "no place is called 'breakfast table'; table_1 is meant";
  const auto [on, answer] = reply({"on", {{"place", "breakfast table"}}});
  EXPECT_THAT(on.notes, testing::ElementsAre(note));
  EXPECT_THAT(to_text(on), HasSubstr("\n  (" + note + ")\n"));
  EXPECT_THAT(full_text(on, answer, TimeWriter(*store_)), HasSubstr("\n  (" + note + ")\n"));
  EXPECT_EQ(full_json(on, answer)["reply"]["notes"][0], note);
  for (const char* name : {"table_1", "table 1", "the table", "on the table", "tables"})
    EXPECT_THAT(reply({"on", {{"place", name}}}).first.notes, testing::IsEmpty()) << name;
  EXPECT_THAT(reply({"where", {{"object", "red"}, {"at", "09:30"}}}).first.notes, testing::IsEmpty());
}

TEST_F(Declarations, AllAnswerWithTextAndJson) {
  for (const Question& question : questions()) {
    Query query{.question = question.name};
    for (const Parameter& parameter : question.parameters) {
      if (!parameter.required) continue;
      query.arguments[parameter.name] = parameter.type == ParameterType::place ? "table_1"
                                        : parameter.choices.empty()            ? "red"
                                                                               : parameter.choices[0];
    }
    if (question.name == "task") query.arguments["object"] = "red";
    if (question.name == "like") continue;  // needs crops
    const Answer answer = ask(*store_, query);
    EXPECT_FALSE(answer.to_text(TimeWriter(*store_)).empty()) << question.name;
    EXPECT_TRUE(answer.to_json().is_object()) << question.name;
  }
}

TEST_F(Declarations, NoQuestionTakesAPeriodThatEndsBeforeItBegins) {
  for (const Question& question : questions()) {
    if (!question.period) continue;
    Query query{.question = question.name, .arguments = {{"from", "12:00"}, {"to", "08:00"}}};
    for (const Parameter& parameter : question.parameters)
      if (parameter.required)
        query.arguments[parameter.name] = parameter.choices.empty() ? "red" : parameter.choices[0];
    EXPECT_THAT([&] { ask(*store_, query); },
                testing::ThrowsMessage<Error>(HasSubstr("the first time is after the second")))
        << question.name;
  }
}

TEST_F(Declarations, WhatIsAlmostAPointIsNone) {
  for (const char* text : {",1,1", "1,,1", "1,1,", "0x10,1,1", "1,1,1,1", "1,nan", "1e400,1"})
    EXPECT_THROW(ask(*store_, {.question = "near", .arguments = {{"around", text}}}), Error) << text;
  for (const char* text : {"1,1", "+1.5, -2,0.5", " 1 ,1"})
    EXPECT_NO_THROW(ask(*store_, {.question = "near", .arguments = {{"around", text}}})) << text;
}

TEST_F(Declarations, AnswersNameWhatTheyMention) {
  const Answer answer = ask(*store_, *parse_query("on table_1"));
  const Mentions mentions = answer.mentions(*store_);
  EXPECT_THAT(mentions.objects, testing::Contains(2));
  EXPECT_THAT(mentions.places, testing::Contains("table_1"));
  EXPECT_FALSE(mentions.scenes.empty());
  EXPECT_EQ(answer.get<ContentsAnswer>().places.size(), 1U);
  EXPECT_EQ(answer.get_if<Json>(), nullptr);
}

TEST_F(Declarations, ArgumentsAreReadAgainstTheMemory) {
  EXPECT_EQ(ask(*store_, *parse_query("scenes --from 10:00")).to_json()["scenes"].size(), 2U);
  EXPECT_EQ(ask(*store_, *parse_query("where red"), at("08:00")).to_json()["objects"][0]["place"], "table_1");
  EXPECT_THROW(ask(*store_, *parse_query("scene-type --scene x")), Error);
  EXPECT_THROW(ask(*store_, *parse_query("search-next red --start 1")), Error);
}

TEST_F(Declarations, NumbersAreWholeAndInRange) {
  for (const char* query : {"on table_1", "objects red", "near red", "changes"})
    for (const char* number : {"abc", "''", "-1", "1.5", "0", "99999999999999999999"}) {
      const std::string option = std::string(query) == "changes" ? " --times " : " --count ";
      EXPECT_THROW(parse_query(query + option + number), Error) << query << option << number;
    }
  EXPECT_EQ(read_number("two"), 2);
  EXPECT_EQ(read_number("12"), 12);
}

TEST_F(Declarations, ACountAsksWhetherThereAreAsMany) {
  const auto asked = [&](const std::string& text) {
    const Query query = *parse_query(text);
    const Question& question = *find_question(query.question);
    const Answer answer = question.ask(*store_, query);
    return full_json(question.reply(*store_, query, answer), answer);
  };
  const Json many = asked("on table_1 --at 08:00 --count 99"), one = asked("on table_1 --at 08:00 --count 1");
  EXPECT_EQ(many["verdict"], "no");
  EXPECT_EQ(many["reply"]["verdict"], "no");
  EXPECT_EQ(one["verdict"], "yes");
  EXPECT_EQ(one["reply"]["verdict"], "yes");
  EXPECT_EQ(asked("objects red --count 99")["reply"]["verdict"], "no");
  EXPECT_FALSE(asked("near red --count 1")["reply"].contains("verdict")) << "only so many";
}

TEST_F(Declarations, EmptyNamesAreRefused) {
  for (const auto& [question, name] : {std::pair("where", "object"), std::pair("on", "place"),
                                       std::pair("near", "around"), std::pair("objects", "object")})
    for (const char* text : {"", "  "})
      EXPECT_THROW(ask(*store_, {.question = question, .arguments = {{name, text}}}), Error) << question;
}

TEST_F(Declarations, WhatATaskIsAboutMayBeGivenByPosition) {
  const auto asked = [&](const char* name) {
    return ask(*store_, {.question = "task", .arguments = {{"task", "set"}, {name, "table_1"}}}).to_json();
  };
  EXPECT_EQ(asked("object"), asked("place"));
  EXPECT_EQ(asked("object"), ask(*store_, *parse_query("task set table_1")).to_json());
  EXPECT_THROW(ask(*store_, {.question = "task", .arguments = {{"task", "set"}}}), Error);
}

TEST(Length, IsReadWithItsUnit) {
  EXPECT_DOUBLE_EQ(read_length("0.5"), 0.5);
  EXPECT_DOUBLE_EQ(read_length("50 cm"), 0.5);
  EXPECT_DOUBLE_EQ(read_length("300mm"), 0.3);
  for (const char* wrong : {"", "cm", "-1", "0", "5 miles", "nan", "1e999", "1 2"})
    EXPECT_THROW(read_length(wrong), Error) << wrong;
}

}  // namespace
}  // namespace loci::memory
