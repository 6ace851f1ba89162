// The question bar: what it suggests, what it answers, and what the links of an answer do.

#include <gtest/gtest.h>

#include <QLineEdit>
#include <QListWidget>
#include <QSettings>
#include <QSignalSpy>
#include <QTest>
#include <QTextBrowser>

#include "gui/core/background.h"
#include "gui/models/question_text.h"
#include "gui/views/question_bar.h"
#include "mapping/base/text/json.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

using test::BrowserWindow;

QStringList texts(const std::vector<Suggestion>& suggestions) {
  QStringList lines;
  for (const Suggestion& suggestion : suggestions) lines << suggestion.text;
  return lines;
}

TEST(Suggestions, CompleteTheNameThatWasBegun) {
  const SuggestionSources sources{{}, {"Where is the red cup?"}, {"red cup", "table_1"}, {}};
  EXPECT_EQ(texts(suggest("what is near the red c", sources, 9)).front(), "what is near the red cup");
  EXPECT_EQ(texts(suggest("what is on ta", sources, 9)).front(), "what is on table_1");
}

TEST(Suggestions, AreTheLastQuestionsWhenNothingIsTyped) {
  const SuggestionSources sources{{"Where is it?"}, {"What changed?", "Where is it?"}, {}, {"Top"}};
  EXPECT_EQ(texts(suggest("", sources, 9)), QStringList({"Where is it?", "What changed?"}));
}

TEST(Suggestions, FindActionsByAnyOfTheirWords) {
  const SuggestionSources sources{{}, {}, {}, {"Depth image", "Top"}};
  EXPECT_EQ(texts(suggest("imag", sources, 9)), QStringList({"Depth image"}));
}

TEST(AnswerLinks, ObjectsPlacesAndTimesAreLinksAndTheRestIsEscaped) {
  const QString html = linked_text("object_1 <red> is on table_1, seen at 08:30:02", {"table", "table_1"});
  EXPECT_TRUE(html.contains("<a href=\"object:1\">object_1</a> &lt;red&gt;")) << html.toStdString();
  EXPECT_TRUE(html.contains("<a href=\"place:table_1\">table_1</a>")) << html.toStdString();
  EXPECT_TRUE(html.contains("<a href=\"time:08:30:02\">08:30:02</a>")) << html.toStdString();
}

TEST(AnswerLinks, AnOffsetBelongsToItsTime) {
  const QString html = linked_text("at 02:30+02:00, not at 02:30", {});
  EXPECT_EQ(html, "at <a href=\"time:02:30+02:00\">02:30+02:00</a>, not at <a href=\"time:02:30\">02:30</a>");
}

class QuestionBarInWindow : public BrowserWindow {
 protected:
  QuestionBar& bar() { return window.question_bar(); }
  QString answer_to(const char* question) {
    bar().line()->selectAll();
    QTest::keyClicks(bar().line(), question);
    QTest::keyClick(bar().line(), Qt::Key_Return);
    settle();
    return bar().answers()->toPlainText();
  }
};

TEST_F(QuestionBarInWindow, SlashOpensItWithQuestionsOfThisMemory) {
  press(Qt::Key_Slash);
  ASSERT_TRUE(bar().isVisible());
  settle();
  ASSERT_GT(bar().suggestions()->count(), 3);
  EXPECT_TRUE(bar().suggestions()->item(0)->text().startsWith("Where is "));
}

TEST_F(QuestionBarInWindow, AnswersInWordsAndSelectsTheOneObjectOfTheAnswer) {
  bar().open();
  const QString answer = answer_to("where is the blue one");
  EXPECT_TRUE(answer.contains("object_2")) << answer.toStdString();
  EXPECT_TRUE(answer.contains("table_1")) << answer.toStdString();
  EXPECT_EQ(selection().object(), 2);
}

TEST_F(QuestionBarInWindow, AnswersAtTheChosenTimeUnlessTheQuestionSaysAnother) {
  go_to(sample_.first);
  bar().open();
  EXPECT_TRUE(answer_to("where is the blue one").contains("is on counter_1"));
  EXPECT_TRUE(answer_to("where is the blue one at 08:00").contains("is on table_1"));
}

TEST_F(QuestionBarInWindow, ItIsTheChosenObject) {
  go_to(sample_.first);
  choose(1);
  bar().open();
  EXPECT_TRUE(answer_to("where is it").contains("object_1"));
}

TEST_F(QuestionBarInWindow, CommandsOfTheCommandLineAreUnderstood) {
  bar().open();
  EXPECT_TRUE(answer_to("on counter_1").contains("object_3"));
  EXPECT_TRUE(answer_to("objects --at 07:00").contains("object_1"));
}

TEST_F(QuestionBarInWindow, ActionsRunByTheirName) {
  bar().open();
  answer_to("first scene");
  EXPECT_EQ(selection().time(), sample_.first);
  EXPECT_FALSE(bar().isVisible());
}

TEST_F(QuestionBarInWindow, WhatIsNotUnderstoodGetsQuestionsThatAre) {
  bar().open();
  const QString answer = answer_to("sing me a song of cups");
  EXPECT_TRUE(answer.contains("not understood")) << answer.toStdString();
  EXPECT_TRUE(bar().answers()->toHtml().contains("ask:"));
}

TEST_F(QuestionBarInWindow, LinksOfAnAnswerSelectInTheViews) {
  bar().open();
  bar().follow(QUrl("object:1"));
  settle();
  EXPECT_EQ(selection().object(), 1);
  EXPECT_EQ(window.docks().card().title(), "object_1");
  bar().follow(QUrl("time:07:30:00"));
  settle();
  EXPECT_EQ(selection().time(), sample_.second);
  bar().follow(QUrl("place:table_1"));
  EXPECT_EQ(selection().place(), "table_1");
}

TEST_F(QuestionBarInWindow, EarlierQuestionsAreOfferedAgainAndEscCloses) {
  bar().open();
  answer_to("where is the red cup");
  bar().line()->clear();
  ASSERT_GT(bar().suggestions()->count(), 0);
  EXPECT_EQ(bar().suggestions()->item(0)->text(), "where is the red cup");
  choose(1);
  QTest::keyClick(bar().line(), Qt::Key_Escape);
  EXPECT_FALSE(bar().isVisible());
  EXPECT_EQ(selection().object(), 1) << "the first Esc only closes the bar";
}

TEST_F(QuestionBarInWindow, UpAndDownGoThroughWhatWasAsked) {
  bar().open();
  answer_to("where is the red cup");
  answer_to("what changed");
  const auto key = [this](Qt::Key which) { QTest::keyClick(bar().line(), which); };
  bar().open();
  key(Qt::Key_Up);
  EXPECT_EQ(bar().line()->text(), "what changed");
  key(Qt::Key_Up);
  EXPECT_EQ(bar().line()->text(), "where is the red cup");
  key(Qt::Key_Up);
  EXPECT_EQ(bar().line()->text(), "where is the red cup") << "the first one";
  key(Qt::Key_Down);
  EXPECT_EQ(bar().line()->text(), "what changed");
  key(Qt::Key_Down);
  EXPECT_EQ(bar().line()->text(), "");
}

TEST(QuestionHistory, IsKeptFromOneStartToTheNext) {
  QSettings().remove("asked");
  const auto opener = [](const std::string& path, Progress& progress) {
    return OpenMemory::open(path, progress);
  };
  const auto path =
      std::filesystem::temp_directory_path() / ("loci_asked_" + std::to_string(getpid()) + ".loci");
  test::write_sample_memory(path);
  for (const bool second : {false, true}) {
    MainWindow window(opener, {MapBackend::memory, true});
    window.show_data(OpenMemory::open(path));
    window.show();
    finish_background();
    if (second) {
      EXPECT_EQ(window.question_bar().asked(), QStringList({"where is the red cup"}));
    } else {
      window.question_bar().ask("where is the red cup");
    }
    finish_background();
  }
  QSettings().remove("asked");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace loci::gui
