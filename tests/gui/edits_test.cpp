// What people say about objects in the browser: facts of source "user", with undo and redo.

#include <QComboBox>
#include <QInputDialog>
#include <QSignalSpy>
#include <QTimer>

#include "gui/core/background.h"
#include "gui/views/timeline/time_bar.h"
#include "mapping/base/error.h"
#include "memory/questions/facts.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

class EditsInWindow : public test::BrowserWindow {
 protected:
  EditsInWindow() {
    window.open(QString::fromStdString(sample_.path.string()));
    settle();
    choose(2);
  }
  std::vector<memory::Fact> facts() {
    return ask(memory::Store::open_read(sample_.path), memory::FactsQuestion{}).facts;
  }
};

TEST_F(EditsInWindow, ARenamedObjectIsCalledSoInAllViews) {
  QTimer::singleShot(100, &window, [] {
    auto* dialog = qobject_cast<QInputDialog*>(QApplication::activeModalWidget());
    ASSERT_NE(dialog, nullptr);
    EXPECT_EQ(dialog->textValue(), "") << "object_2 is no name of its own";
    dialog->setTextValue("cereal");
    dialog->accept();
  });
  press(Qt::Key_F2);
  settle();
  EXPECT_EQ(window.docks().card().title(), "cereal");
  EXPECT_EQ(window.docks().tree().shown_index_of_object(2).data().toString(), "cereal");
  ASSERT_EQ(facts().size(), 1U);
  EXPECT_EQ(facts()[0].source, "user");
  EXPECT_EQ(facts()[0].value, "cereal");
}

TEST_F(EditsInWindow, ARenamedPlaceIsCalledSoInTreeMapAndAnswers) {
  selection().select_place("table_1");
  settle();
  QTimer::singleShot(100, &window, [] {
    auto* dialog = qobject_cast<QInputDialog*>(QApplication::activeModalWidget());
    ASSERT_NE(dialog, nullptr);
    EXPECT_EQ(dialog->textValue(), "table_1");
    dialog->setTextValue("breakfast table");
    dialog->accept();
  });
  press(Qt::Key_F2);
  settle();
  EXPECT_EQ(place_of(2), "breakfast table");
  EXPECT_NE(window.browser().data()->world()->find_link("breakfast table"), nullptr);
  EXPECT_TRUE(window.docks().tree().shown_index_of_object(2).parent().data().toString().startsWith(
      "breakfast table"));
  EXPECT_EQ(window.browser().data()->find("breakfast table", sample_.third).place, "breakfast table");
  EXPECT_EQ(selection().place(), "breakfast table") << "it stays selected";
  window.edits().undo();
  settle();
  EXPECT_EQ(place_of(2), "table_1");
  EXPECT_NE(window.browser().data()->world()->find_link("table_1"), nullptr);
}

TEST_F(EditsInWindow, ANamedJointGoesOnMovingAndAPartThatIsNoPlaceCanBeNamed) {
  const QSignalSpy warned(&window.map(), &MapView::warned);
  window.edits().name_part("drawer_2_front_joint", "cutlery slide");
  settle();
  go_to(sample_.second);
  EXPECT_EQ(window.browser().belief().joints.at("cutlery slide"), 0.35);
  EXPECT_NE(window.browser().data()->world()->find_joint("cutlery slide"), nullptr);
  EXPECT_EQ(window.map().joints().count("drawer_2_front_joint"), 0U);
  selection().select_place("drawer_2_front");
  settle();
  QTimer::singleShot(100, &window, [] {
    auto* dialog = qobject_cast<QInputDialog*>(QApplication::activeModalWidget());
    ASSERT_NE(dialog, nullptr);
    dialog->setTextValue("cutlery");
    dialog->accept();
  });
  press(Qt::Key_F2);
  settle();
  EXPECT_EQ(window.browser().data()->world()->parent_joint("cutlery")->name, "cutlery slide");
  EXPECT_EQ(selection().place(), "cutlery");
  window.edits().undo();
  settle();
  window.edits().undo();
  settle();
  EXPECT_EQ(window.browser().belief().joints.at("drawer_2_front_joint"), 0.35);
  EXPECT_EQ(warned.count(), 0) << warned.value(0).value(0).toString().toStdString();
}

TEST_F(EditsInWindow, UndoAndRedoRestoreWhatHeldAndLoseNothing) {
  EditHistory& edits = window.edits();
  EXPECT_FALSE(edits.can_undo());
  for (const char* owner : {"Ada", "Grace"}) {
    edits.set_fact("object_2", "owner", owner);
    settle();
  }
  const auto owner = [&] { return facts().empty() ? "" : facts().back().value; };
  EXPECT_EQ(owner(), "Grace");
  press(Qt::Key_Z, Qt::ControlModifier);
  settle();
  EXPECT_EQ(owner(), "Ada");
  EXPECT_EQ(window.browser().belief().names->owner_of(2), "Ada");
  edits.undo();
  settle();
  EXPECT_EQ(owner(), "");
  EXPECT_FALSE(edits.can_undo());
  edits.redo();
  settle();
  EXPECT_EQ(owner(), "Ada");
  EXPECT_TRUE(edits.can_redo());
  edits.set_fact("object_2", "owner", "Alan");
  settle();
  EXPECT_FALSE(edits.can_redo()) << "a new edit ends what could be redone";
  const memory::Store store = memory::Store::open_read(sample_.path);
  EXPECT_EQ(store.runs().size(), 7U) << "one run of the memory, and one for each that was said or taken back";
}

TEST_F(EditsInWindow, AnotherNameReplacesTheFirstInTheWindow) {
  for (const char* name : {"box", "cereal"}) {
    window.edits().set_fact("object_2", "alias", name);
    settle();
    EXPECT_EQ(window.docks().card().title(), name);
  }
  press(Qt::Key_Z, Qt::ControlModifier);
  EXPECT_EQ(window.docks().card().title(), "box");
}

TEST_F(EditsInWindow, MergedObjectsAreOneInAllViewsAndUndoBringsTheOtherBack) {
  ASSERT_NE(window.browser().belief().find(3), nullptr);
  window.edits().merge(1, 3);
  settle();
  EXPECT_EQ(window.browser().belief().find(3), nullptr);
  ASSERT_NE(window.browser().belief().find(1), nullptr);
  EXPECT_EQ(window.browser().belief().find(1)->status, memory::ObjectStatus::seen)
      << "the cup that was gone is the tin";
  EXPECT_EQ(drawn(3), nullptr);
  press(Qt::Key_Z, Qt::ControlModifier);
  EXPECT_NE(window.browser().belief().find(3), nullptr);
  EXPECT_EQ(window.browser().belief().find(1)->status, memory::ObjectStatus::gone);
}

TEST_F(EditsInWindow, TheSecondClockShowsWhatWasKnownBeforeAnEdit) {
  window.edits().merge(1, 3);
  settle();
  QComboBox* known = window.docks().time_bar().known();
  ASSERT_GE(known->count(), 2);
  EXPECT_TRUE(known->itemText(1).contains("object_3 is object_1")) << known->itemText(1).toStdString();
  selection().set_known_at(known->itemData(1).toLongLong());
  settle();
  EXPECT_NE(window.browser().belief().find(3), nullptr) << "then they were two";
  selection().set_known_at({});
  settle();
  EXPECT_EQ(window.browser().belief().find(3), nullptr);
}

TEST_F(EditsInWindow, FromTheChosenTimeOnItIsAnother) {
  go_to(sample_.second);
  press(Qt::Key_J, Qt::ControlModifier | Qt::ShiftModifier);
  settle();
  EXPECT_EQ(place_of(4), "table_1");
  EXPECT_EQ(place_of(2), "counter_1");
}

TEST_F(EditsInWindow, WhileAnotherProgramWritesTheEditIsRefusedWithTheReason) {
  QSignalSpy failed(&window.browser(), &Browser::failed);
  const memory::Store writer = memory::Store::open_write(sample_.path);
  window.edits().set_fact("object_2", "class", "cup");
  settle();
  EXPECT_EQ(failed.count(), 1);
  EXPECT_FALSE(window.edits().can_undo());
}

}  // namespace
}  // namespace loci::gui
