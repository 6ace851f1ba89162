// The ten questions of docs/browser.md that a new user has, with the clicks that they take: at most three
// each.

#include <QInputDialog>
#include <QLineEdit>
#include <QListWidget>
#include <QTabBar>
#include <QTableView>
#include <QTextBrowser>
#include <QTimer>

#include "gui/views/compare_view.h"
#include "gui/views/object_card.h"
#include "gui/views/question_bar.h"
#include "gui/views/scene_view.h"
#include "gui/views/timeline/time_bar.h"
#include "gui/views/timeline/time_track.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

class Walk : public test::BrowserWindow {
 protected:
  /// Each of these is one click, or one key.
  void click_at(QWidget* widget, const QPoint& point) {
    ++clicks_;
    click(widget, point);
  }
  void click_object(int64_t object) {
    ++clicks_;
    click_in_tree(object);
  }
  void click_time(TimeNs time) {
    TimeTrack* track = window.docks().time_bar().track();
    click_at(track, QPoint(static_cast<int>(track->x_of(time)), track->height() / 2));
  }
  /// A tab by its text: of the docks, or of the card's pages.
  void click_tab(const QString& text) {
    for (QTabBar* bar : window.findChildren<QTabBar*>())
      for (int i = 0; i < bar->count(); ++i)
        if (bar->tabText(i) == text && bar->isVisible()) return click_at(bar, bar->tabRect(i).center());
    FAIL() << "no tab " << text.toStdString();
  }
  void key(Qt::Key which) {
    ++clicks_;
    press(which);
  }
  bool card_says(const char* text) { return window.docks().card().text().contains(text); }
  ~Walk() override { EXPECT_LE(clicks_, 3); }

  int clicks_ = 0;
};

TEST_F(Walk, WhereIsIt) {
  click_object(2);
  EXPECT_TRUE(card_says("Place: table_1"));
}

TEST_F(Walk, WhenWasItSeenLastAndIsItStillThere) {
  click_object(2);
  EXPECT_TRUE(card_says("Last seen: 2026-05-01"));
  EXPECT_TRUE(card_says("Still there: 93 %"));
}

TEST_F(Walk, WhatWasSeenAtHalfPastSeven) {
  click_time(sample_.second);
  EXPECT_EQ(window.browser().moment().content->scene.time, sample_.second);
  EXPECT_TRUE(window.docks().image().box_of(2).has_value());
}

TEST_F(Walk, WhatIsThisInTheImage) {
  const auto box = window.docks().image().box_of(3);
  ASSERT_TRUE(box.has_value());
  click_at(&window.docks().image(), box->center().toPoint());
  EXPECT_EQ(window.docks().card().title(), "object_3");
}

TEST_F(Walk, WhenAndFromWhereWasItMoved) {
  click_object(2);
  const QAbstractItemModel* model = window.docks().card().history()->model();
  int moved = -1;
  for (int row = 0; row < model->rowCount(); ++row)
    if (model->index(row, 1).data().toString() == "moved") moved = row;
  ASSERT_GE(moved, 0);
  QTableView* table = window.docks().card().history();
  click_at(table->viewport(), table->visualRect(model->index(moved, 1)).center());
  EXPECT_EQ(selection().time(), sample_.second);
}

TEST_F(Walk, WhatHasChangedSinceTheBeginning) {
  click_tab("Compare");
  EXPECT_EQ(window.docks().compare().table()->model()->rowCount(), 3);
}

TEST_F(Walk, WhatDoesItLookLikeFromOtherSides) {
  click_object(2);
  click_tab("Images");
  EXPECT_EQ(window.docks().card().pages()->images()->count(), 2);
}

TEST_F(Walk, WhyIsThatBelieved) {
  click_object(2);
  click_tab("Why");
  EXPECT_FALSE(window.docks().card().pages()->why()->toPlainText().isEmpty());
}

TEST_F(Walk, CanItBeAskedInWords) {
  key(Qt::Key_Slash);
  QTest::keyClicks(window.question_bar().line(), "what is on table_1");
  ++clicks_;
  QTest::keyClick(window.question_bar().line(), Qt::Key_Return);
  settle();
  EXPECT_TRUE(window.question_bar().answers()->toPlainText().contains("object_2"));
}

TEST_F(Walk, HowIsItGivenAName) {
  // As a person does; it is followed from then on.
  window.open(QString::fromStdString(sample_.path.string()));
  settle();
  click_object(2);
  ++clicks_;
  QTimer::singleShot(100, &window, [] {
    auto* dialog = qobject_cast<QInputDialog*>(QApplication::activeModalWidget());
    ASSERT_NE(dialog, nullptr);
    dialog->setTextValue("cereal");
    dialog->accept();
  });
  press(Qt::Key_F2);
  settle();
  window.files().loader().check();  // the window does this by itself every second and a half
  settle();
  EXPECT_EQ(window.docks().card().title(), "cereal");
}

}  // namespace
}  // namespace loci::gui
