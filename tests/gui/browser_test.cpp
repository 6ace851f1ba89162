#include <gtest/gtest.h>

#include <QApplication>
#include <QDropEvent>
#include <QLineEdit>
#include <QMimeData>
#include <QMouseEvent>
#include <QSignalSpy>
#include <QTableView>
#include <QTest>
#include <QTreeView>
#include <set>

#include "gui/core/background.h"
#include "gui/data/open_memory.h"
#include "gui/scene3d/object_actors.h"
#include "gui/views/object_card.h"
#include "gui/views/objects_tree.h"
#include "gui/views/scene_view.h"
#include "gui/views/timeline/time_bar.h"
#include "gui/views/timeline/time_track.h"
#include "gui/window/main_window.h"
#include "gui/window/menus.h"
#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/questions/objects.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

using test::BrowserWindow;

TEST_F(BrowserWindow, OpensAtTheLastSceneWithFileAndSchemaInTheTitle) {
  EXPECT_EQ(selection().time(), sample_.third);
  EXPECT_TRUE(window.windowTitle().contains("sample.loci")) << window.windowTitle().toStdString();
  EXPECT_TRUE(window.windowTitle().contains("schema 1."));
}

TEST_F(BrowserWindow, ClickInTheTreeSelectsInMapAndCard) {
  go_to(sample_.first);
  click_in_tree(1);
  EXPECT_EQ(selection().object(), 1);
  EXPECT_EQ(window.map().scene().selected_object(), 1);
  EXPECT_EQ(window.docks().card().title(), "object_1");
  EXPECT_TRUE(window.docks().card().text().contains("counter_1"));
  EXPECT_GE(window.docks().card().history()->model()->rowCount(), 2);
}

TEST_F(BrowserWindow, ClickOnABoxInTheImageSelectsItsObject) {
  go_to(sample_.first);
  const auto box = window.docks().image().box_of(2);
  ASSERT_TRUE(box.has_value());
  click(&window.docks().image(), box->center().toPoint());
  EXPECT_EQ(selection().object(), 2);
  EXPECT_EQ(window.docks().tree().view()->currentIndex(), window.docks().tree().shown_index_of_object(2));
}

TEST_F(BrowserWindow, ClickInTheMapSelectsWhatIsThere) {
  go_to(sample_.first);
  choose(2);
  window.map().frame_selection();
  selection().clear();
  QWidget* canvas = window.map().childAt(window.map().rect().center());
  click(canvas, canvas->rect().center());
  EXPECT_EQ(selection().object(), 2);
}

/// As on a machine without a graphics card.
class WindowDrawnInMemory : public BrowserWindow {
 protected:
  WindowDrawnInMemory() : test::BrowserWindow(MapBackend::memory) {}
};

TEST_F(WindowDrawnInMemory, TheMapTakesClicksAndDrags) {
  go_to(sample_.first);
  choose(2);
  window.map().frame_selection();
  selection().clear();
  settle();
  QWidget* canvas = &window.map().canvas();
  const QImage before = canvas->grab().toImage();
  const QPoint middle = canvas->rect().center(), aside = middle + QPoint(60, 0);
  click(canvas, middle);
  EXPECT_EQ(selection().object(), 2);
  selection().clear();
  settle();
  QTest::mousePress(canvas, Qt::LeftButton, Qt::NoModifier, middle);
  QMouseEvent drag(QEvent::MouseMove, aside, canvas->mapToGlobal(aside), Qt::LeftButton, Qt::LeftButton,
                   Qt::NoModifier);
  QApplication::sendEvent(canvas, &drag);
  QTest::mouseRelease(canvas, Qt::LeftButton, Qt::NoModifier, aside);
  settle();
  EXPECT_FALSE(selection().object().has_value()) << "a drag chooses nothing";
  EXPECT_NE(canvas->grab().toImage(), before) << "it was turned";
}

TEST_F(BrowserWindow, TheSliderChangesWhatIsBelieved) {
  TimeTrack* track = window.docks().time_bar().track();
  const auto click_at = [&](TimeNs time) {
    click(track, QPoint(static_cast<int>(track->x_of(time)), track->height() / 2));
  };
  click_at(sample_.first);
  EXPECT_EQ(selection().time(), sample_.first);
  ASSERT_NE(window.browser().belief().find(1), nullptr);
  EXPECT_EQ(window.browser().belief().find(1)->status, memory::ObjectStatus::seen);
  EXPECT_EQ(window.browser().belief().find(3), nullptr);
  EXPECT_FALSE(drawn(1)->ghost);

  click_at(sample_.second);
  EXPECT_EQ(window.browser().belief().find(1)->status, memory::ObjectStatus::out_of_view);
  EXPECT_TRUE(drawn(1)->ghost);
  EXPECT_EQ(place_of(2), "table_1");

  click_at(sample_.third);
  EXPECT_EQ(window.browser().belief().find(1)->status, memory::ObjectStatus::gone);
  EXPECT_EQ(drawn(1), nullptr);
  EXPECT_NE(drawn(3), nullptr);
}

TEST_F(BrowserWindow, KeysStepThroughTheScenes) {
  press(Qt::Key_Home);
  EXPECT_EQ(selection().time(), sample_.first);
  press(Qt::Key_Right);
  EXPECT_EQ(selection().time(), sample_.second);
  press(Qt::Key_End);
  EXPECT_EQ(selection().time(), sample_.third);
  press(Qt::Key_Left);
  EXPECT_EQ(selection().time(), sample_.second);
  choose(1);
  press(Qt::Key_Left, Qt::ControlModifier);
  EXPECT_EQ(selection().time(), sample_.first) << "the observation before";
  press(Qt::Key_Escape);
  EXPECT_FALSE(selection().object().has_value());
}

TEST_F(BrowserWindow, SpacePlaysFromTheBeginningAndStops) {
  press(Qt::Key_Space);
  EXPECT_TRUE(window.docks().time_bar().plays());
  EXPECT_EQ(selection().time(), sample_.first);
  press(Qt::Key_Space);
  EXPECT_FALSE(window.docks().time_bar().plays());
}

TEST_F(BrowserWindow, TypedTimesAreTakenAndNonsenseIsRefused) {
  QLineEdit* stamp = window.docks().time_bar().stamp();
  const auto type = [&](const char* text) {
    stamp->setText(text);
    QTest::keyClick(stamp, Qt::Key_Return);
    settle();
  };
  type("2026-05-01 07:30:00");
  EXPECT_EQ(selection().time(), sample_.second);
  type("07:00");
  EXPECT_EQ(selection().time(), sample_.first);
  QSignalSpy failed(&window.browser(), &Browser::failed);
  type("tea time");
  EXPECT_EQ(failed.count(), 1);
  EXPECT_EQ(selection().time(), sample_.first);
  EXPECT_EQ(stamp->text(), "2026-05-01 07:00:00");
}

TEST_F(BrowserWindow, ATimeWithoutASceneSaysWhichSceneIsShown) {
  const auto shown = [&](TimeNs time) {
    go_to(time);
    return window.docks().time_bar().scene_text().toStdString();
  };
  EXPECT_EQ(shown(sample_.first).substr(0, 10), "scene 1 of");
  EXPECT_EQ(shown(sample_.first).find(','), std::string::npos);
  EXPECT_TRUE(shown(sample_.first - 2 * kHour).starts_with("no scene yet"));
  EXPECT_TRUE(shown(sample_.first + 5 * kMinute).ends_with(", 5 min before"));
}

TEST_F(BrowserWindow, SearchShowsWhatMatchesAndKeepsTheSelection) {
  go_to(sample_.first);
  choose(1);
  window.docks().tree().search()->setText("blue");
  EXPECT_FALSE(window.docks().tree().shown_index_of_object(1).isValid());
  EXPECT_TRUE(window.docks().tree().shown_index_of_object(2).isValid());
  EXPECT_EQ(selection().object(), 1);
  window.docks().tree().search()->clear();
  EXPECT_TRUE(window.docks().tree().view()->selectionModel()->isSelected(
      window.docks().tree().shown_index_of_object(1)));
}

TEST_F(BrowserWindow, WhatIsGoneIsInAGroupOfItsOwn) {
  go_to(sample_.third);
  const QModelIndex cup = window.docks().tree().shown_index_of_object(1);
  EXPECT_TRUE(cup.parent().data().toString().startsWith("gone"));
}

TEST_F(BrowserWindow, MapAndCloudAreDrawnWithinTheirLimits) {
  go_to(sample_.first);
  EXPECT_GT(window.map().scene().point_count(), 1000U);
  EXPECT_LE(window.map().scene().point_count(), 50000U);
  EXPECT_FALSE(window.map().scene().shown_labels().empty());
}

TEST_F(BrowserWindow, DroppedFileIsOpened) {
  const std::filesystem::path other = folder_.path / "dropped.loci";
  std::filesystem::copy_file(sample_.path, other);
  QMimeData files;
  files.setUrls({QUrl::fromLocalFile(QString::fromStdString(other.string()))});
  QDragEnterEvent enter(QPoint(100, 100), Qt::CopyAction, &files, Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(&window, &enter);
  EXPECT_TRUE(enter.isAccepted());
  QDropEvent drop(QPointF(100, 100), Qt::CopyAction, &files, Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(&window, &drop);
  finish_background();
  EXPECT_TRUE(window.windowTitle().contains("dropped.loci"));
}

TEST_F(BrowserWindow, EveryActionWithAKeyIsOnTheSheetAndNoKeyIsGivenTwice) {
  const QStringList lines = ShortcutSheet::lines_of(window.menus().menus());
  EXPECT_GE(lines.size(), 20);
  std::set<QString> keys;
  for (const QString& line : lines)
    for (const QString& key : line.section('\t', 1).split(" or "))
      EXPECT_TRUE(keys.insert(key).second) << key.toStdString();
  EXPECT_TRUE(keys.contains("?"));
}

TEST_F(BrowserWindow, LayersCanBeHidden) {
  window.map().set_layer(MapLayer::objects, false);
  window.screenshot();
  EXPECT_TRUE(window.map().scene().shown_labels().empty());
  window.map().set_layer(MapLayer::objects, true);
  window.screenshot();
  EXPECT_FALSE(window.map().scene().shown_labels().empty());
}

TEST_F(BrowserWindow, AnEmptyWindowSaysWhatToDo) {
  window.show_data(nullptr);
  EXPECT_EQ(window.windowTitle(), "loci");
  EXPECT_TRUE(window.docks().card().title().isEmpty());
  EXPECT_NO_THROW(window.screenshot());
}

TEST_F(BrowserWindow, SaysTheSameAsTheQuestionsOfTheCommandLine) {
  const memory::Store store = memory::Store::open_read(sample_.path);
  for (const TimeNs time : {sample_.first, sample_.second, sample_.second + 10 * kMinute, sample_.third}) {
    go_to(time);
    const auto states = ask(store, memory::ObjectsQuestion{{}, {time, std::nullopt}}).objects;
    EXPECT_EQ(states.size(), window.browser().belief().objects.size());
    for (const memory::ObjectBelief& state : states) {
      const BelievedObject* shown = window.browser().belief().find(state.object.id);
      ASSERT_NE(shown, nullptr) << state.object.name;
      EXPECT_EQ(window.browser().belief().name_of(*shown), state.object.name);
      EXPECT_EQ(place_of(shown->object), state.place->name);
      EXPECT_DOUBLE_EQ(shown->probability, state.probability);
      EXPECT_EQ(shown->last_seen, state.last_seen->time);
      EXPECT_EQ(shown->status, state.status);
      EXPECT_EQ(shown->size, state.object.size);
      EXPECT_EQ(shown->position, state.position);
    }
  }
}

TEST_F(BrowserWindow, ScreenshotIsNotBlank) {
  const QImage image = window.screenshot();
  EXPECT_EQ(image.size(), window.size() * window.devicePixelRatio());
  const QRect map = QRect(window.map().mapTo(&window, QPoint(0, 0)), window.map().size());
  std::set<QRgb> colors;
  for (int y = map.top(); y < map.bottom(); y += 3)
    for (int x = map.left(); x < map.right(); x += 3) colors.insert(image.pixel(x, y));
  EXPECT_GT(colors.size(), 200U);
}

TEST_F(BrowserWindow, NothingIsClippedAtTheSmallestSizePromised) {
  choose(1);  // a card that says all it can needs the most room
  for (const char* dock : {"compare", "statistics", "log", "selection"}) window.docks().show(dock);
  window.resize(1280, 800);
  QTest::qWait(50);
  EXPECT_LE(window.width(), 1280);
  EXPECT_LE(window.height(), 800);
  EXPECT_LE(window.minimumSizeHint().height(), 800);
  for (const QWidget* view :
       std::initializer_list<const QWidget*>{&window.map(), &window.docks().tree(), &window.docks().image(),
                                             &window.docks().card(), &window.docks().time_bar()})
    EXPECT_TRUE(window.rect().contains(QRect(view->mapTo(&window, QPoint(0, 0)), view->size())));
}

}  // namespace
}  // namespace loci::gui
