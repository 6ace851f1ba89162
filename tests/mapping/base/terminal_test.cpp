#include "mapping/base/terminal.h"

#include <gtest/gtest.h>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci {
namespace {

TEST(TerminalText, KeepsWhatPeopleRead) {
  for (const char* text : {"", "a mug\n\ton table_1",
                           "Gr\xc3\xbc\xc3\x9f"
                           "e, \xe2\x86\x92 \xf0\x9f\x98\x80"})
    EXPECT_EQ(terminal_text(text), text);
}

TEST(TerminalText, NothingSteersTheTerminal) {
  EXPECT_EQ(terminal_text("\x1b]0;title\x07"), "\\u001b]0;title\\u0007");
  EXPECT_EQ(terminal_text("over\rwritten\x7f"), "over\\u000dwritten\\u007f");
  EXPECT_EQ(terminal_text("\xc2\x9b"
                          "31m"),
            "\\u009b31m")
      << "C1 control";
  EXPECT_EQ(terminal_text("\xe2\x80\xae"
                          "gpj.exe"),
            "\\u202egpj.exe")
      << "right to left";
  EXPECT_EQ(terminal_text(std::string_view("a\0b", 3)), "a\\u0000b");
}

TEST(TerminalText, BytesThatAreNotUtf8AreShown) {
  EXPECT_EQ(terminal_text("\x9b"
                          "31m"),
            "\\x9b31m");
  EXPECT_EQ(terminal_text("\xc3"), "\\xc3");
  EXPECT_EQ(terminal_text("\xc0\x9b"), "\\xc0\\x9b") << "overlong";
  EXPECT_EQ(terminal_text("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "surrogate";
}

TEST(TerminalText, JsonStaysJson) {
  const Json json = {{"text", "a\x1b[2J\x7f\xc2\x9b\n"}};
  EXPECT_EQ(Json::parse(terminal_text(json.dump())), json);
}

TEST(Error, TextIsOneLineOfBoundedLength) {
  const std::string text = Error(std::string(1 << 20, 'x') + "\r\nend").what();
  EXPECT_LT(text.size(), 5000U);
  EXPECT_EQ(text.find_first_of("\r\n"), std::string::npos);
  EXPECT_TRUE(text.ends_with("end"));
}

TEST(Error, AVeryLongNameIsNotComparedWithOthers) {
  const std::string name(1 << 20, 'a');
  EXPECT_EQ(nearest_name(name, {name + "b"}), "");
  EXPECT_EQ(nearest_name("levled", {"levelled", std::string(1 << 20, 'l')}), "levelled");
}

}  // namespace
}  // namespace loci
