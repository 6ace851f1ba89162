// Object identities, annotations and transaction time in the browser.

#include <QComboBox>
#include <QListWidget>
#include <QTextBrowser>

#include "gui/views/identity_view.h"
#include "gui/views/object_card.h"
#include "gui/views/timeline/time_bar.h"
#include "memory/store/scene_transaction.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

/// One observation; it is object_1 rather than object_2, and object_3 is gone.
SceneDecisions one_decision() {
  DecidedObservation seen;
  seen.object = 1;
  seen.key = 11;
  seen.name = "object_1";
  seen.explanation = "stay";
  seen.probability = 0.9;
  seen.appear = 0.05;
  seen.considered = {{11, 1, "object_1", 0.9, 0.95, 0.8, ""},
                     {12, 2, "object_2", 0.04, 0.3, 0.1, "too far away"}};
  SceneDecisions decisions;
  decisions.kept = true;
  decisions.observations = {seen};
  decisions.unseen = {{13, 3, "object_3", 0.97, 0.02, 0.01}};
  return decisions;
}

TEST(DecisionMatrix, SaysWhatWasConsideredAndWhyItWasNotTaken) {
  DecisionMatrix matrix;
  matrix.set(one_decision());
  matrix.resize(320, matrix.sizeHint().height());
  QStringList texts;
  for (int y = 0; y < matrix.height(); y += 4)
    for (int x = 0; x < matrix.width(); x += 4) texts << matrix.text_at({x, y});
  const QString all = texts.join("\n");
  for (const char* said : {"taken for object_1 (stay, 90 %)", "object_2: is it 4 %",
                           "not taken: too far away", "object_3: gone, 97 %", "something new, 5 %"})
    EXPECT_TRUE(all.contains(said)) << said;
}

TEST(DecisionMatrix, WhatWasChosenIsRedAndProbableIsDark) {
  DecisionMatrix matrix;
  matrix.set(one_decision());
  matrix.resize(320, matrix.sizeHint().height());
  const QImage image = matrix.grab().toImage();
  int red = 0, dark = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 100; x < image.width(); ++x) {
      const QColor color = image.pixelColor(x, y);
      red += color.red() > 200 && color.green() < 60;
      dark += color.lightness() < 60;
    }
  EXPECT_GT(red, 100);
  EXPECT_GT(dark, 400);
}

class IdentityInWindow : public test::BrowserWindow {
 protected:
  void show(const char* dock) {
    window.docks().show(dock);
    settle();
  }
};

TEST_F(IdentityInWindow, LinesLeadToTheEarlierSight) {
  show("identity");
  go_to(sample_.second);
  const auto& lines = window.docks().identity().lines().lines();
  ASSERT_EQ(lines.size(), 1U) << "the box was seen on the counter and on the table";
  EXPECT_EQ(lines[0].earlier_scene, 0U);
  EXPECT_EQ(lines[0].scene, 1U);
  EXPECT_DOUBLE_EQ(lines[0].probability, 0.97);
  EXPECT_TRUE(lines[0].chosen);
}

TEST_F(IdentityInWindow, ReasoningOfAnotherVersionIsNamedWithWhatToDo) {
  {
    memory::Store store = memory::Store::open_write(sample_.path);
    const memory::Id run = store.begin_run("another version", "{}"), scene = store.scenes()[1].id;
    memory::SceneTransaction rows(store, run);
    rows.set_reasoning(scene, std::string("\xa0\x06\x63", 3));  // field 100: version 99
    rows.commit();
  }
  window.show_data(OpenMemory::open(sample_.path));
  show("identity");
  const QSignalSpy failures(&window.browser(), &Browser::failed);
  go_to(sample_.second);
  const QString state = window.docks().identity().state();
  EXPECT_TRUE(state.contains("another version of loci wrote it")) << state.toStdString();
  EXPECT_TRUE(state.contains("loci-perceive run")) << state.toStdString();
  EXPECT_FALSE(window.docks().identity().lines().lines().empty()) << "associations are shown without it";
  EXPECT_EQ(failures.count(), 0);
}

TEST_F(IdentityInWindow, TheCardShowsItsImagesAndWhyItIsBelieved) {
  choose(2);
  window.docks().card().pages()->setCurrentIndex(1);
  settle();
  EXPECT_EQ(window.docks().card().pages()->images()->count(), 2) << "it was looked at from two sides";
  window.docks().card().pages()->setCurrentIndex(3);
  settle();
  EXPECT_FALSE(window.docks().card().pages()->why()->toPlainText().isEmpty());
}

TEST_F(IdentityInWindow, TheSecondClockShowsWhatWasKnownBeforeARunAddedMore) {
  {
    memory::Store store = memory::Store::open_write(sample_.path);
    memory::BeliefRow row = *store.belief(2);
    row.place = store.belief(1, {sample_.first, std::nullopt})->place;
    row.scene.reset();
    row.status = memory::ObjectStatus::out_of_view;
    row.clock = {.valid_from = sample_.third + kSecond};
    const memory::Id run = store.begin_run("somebody who knows better", "{}");
    {
      memory::SceneTransaction rows(store, run);
      rows.add_belief(row);
      rows.commit();
    }
    store.finish_run(run);
  }
  window.show_data(OpenMemory::open(sample_.path));
  go_to(sample_.third + 2 * kSecond);
  EXPECT_EQ(place_of(2), "counter_1");
  QComboBox* known = window.docks().time_bar().known();
  ASSERT_EQ(known->count(), 2) << "now, and before the second run";
  EXPECT_TRUE(known->itemText(1).contains("somebody who knows better"));
  selection().set_known_at(known->itemData(1).toLongLong());
  settle();
  EXPECT_EQ(place_of(2), "table_1");
  selection().set_known_at({});
  settle();
  EXPECT_EQ(place_of(2), "counter_1");
}

}  // namespace
}  // namespace loci::gui
