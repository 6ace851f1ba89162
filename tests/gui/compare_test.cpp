// Two times side by side.

#include <QCheckBox>
#include <QLineEdit>
#include <QTableView>

#include "gui/data/differences.h"
#include "gui/views/compare_view.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

constexpr memory::Id kTable = 1, kShelf = 2, kDrawer = 3;

BelievedObject at(memory::Id id, memory::Id place, double x,
                  memory::ObjectStatus status = memory::ObjectStatus::seen) {
  BelievedObject object;
  object.object = id;
  object.place = place;
  object.status = status;
  object.position = Vector3d(x, 0, 0);
  return object;
}

Belief belief_of(TimeNs time, std::vector<BelievedObject> objects, const JointState& joints = {}) {
  Names names;
  names.places = {{kTable, "table"}, {kShelf, "shelf"}, {kDrawer, "drawer"}};
  names.joint_of_place = {{kDrawer, "drawer_joint"}};
  return {time, std::move(objects), joints, nullptr, std::make_shared<const Names>(std::move(names))};
}

TEST(Differences, TellApartWhatMovedFromTheNoiseOfALook) {
  const Belief then = belief_of(0, {at(1, kTable, 0), at(2, kTable, 0), at(3, kTable, 0)});
  const Belief now = belief_of(1, {at(1, kTable, 0.01), at(2, kTable, 0.3), at(3, kShelf, 0.01)});
  const auto all = differences(then, now);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].object, 2);
  EXPECT_NEAR(all[0].distance, 0.3, 1e-9);
  EXPECT_EQ(all[1].object, 3);
  EXPECT_EQ(all[1].now, "shelf");
}

TEST(Differences, APlaceOfAnotherNameInAnotherMemoryMovesNothing) {
  const Belief there = belief_of(0, {at(1, kTable, 0), at(2, kTable, 0)});
  const Belief here = belief_of(0, {at(1, kShelf, 0.01), at(2, kShelf, 0.3)});
  EXPECT_EQ(differences(there, here).size(), 2U);
  const auto all = differences(there, here, PlaceNames::of_two_memories);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].object, 2);
}

TEST(Differences, AreTurnedAroundWhenTheTimesAre) {
  const Belief then =
      belief_of(0, {at(1, kTable, 0), at(2, kTable, 0, memory::ObjectStatus::gone)}, {{"drawer", 0.0}});
  const Belief now =
      belief_of(1, {at(1, kTable, 0, memory::ObjectStatus::gone), at(2, kTable, 0)}, {{"drawer", 0.3}});
  const auto forward = differences(then, now), back = differences(now, then);
  ASSERT_EQ(forward.size(), 3U);
  EXPECT_EQ(forward[0].kind, memory::EventKind::appeared);
  EXPECT_EQ(forward[0].object, 2);
  EXPECT_EQ(forward[1].kind, memory::EventKind::gone);
  EXPECT_EQ(forward[1].object, 1);
  EXPECT_EQ(forward[2].kind, memory::EventKind::joint_changed);
  ASSERT_EQ(back.size(), 3U);
  EXPECT_EQ(back[0].object, 1);
  EXPECT_TRUE(differences(now, now).empty());
}

/// A drawer that is pulled along x.
std::shared_ptr<const mapping::World> world_with_drawer() {
  mapping::World world;
  for (const char* name : {"room", "front"}) world.links.emplace_back().name = name;
  mapping::Joint joint;
  joint.name = "drawer_joint";
  joint.type = mapping::JointType::prismatic;
  joint.parent = "room";
  joint.child = "front";
  world.joints = {joint};
  world.root = "room";
  return std::make_shared<const mapping::World>(std::move(world));
}

TEST(Differences, WhatADrawerTakesAlongIsNotMoved) {
  Belief then = belief_of(0, {at(1, kDrawer, 0.45), at(2, kDrawer, 0.5)}, {{"drawer_joint", 0.45}});
  Belief now = belief_of(1, {at(1, kDrawer, 0.01), at(2, kDrawer, 0.3)}, {{"drawer_joint", 0.0}});
  then.world = now.world = world_with_drawer();
  const auto all = differences(then, now);
  ASSERT_EQ(all.size(), 2U) << "the drawer, and what was moved in it";
  EXPECT_EQ(all[0].object, 2);
  EXPECT_NEAR(all[0].distance, 0.25, 1e-9);
  EXPECT_EQ(all[1].then, "45 cm");
  EXPECT_EQ(all[1].now, "0 cm");
}

class CompareInWindow : public test::BrowserWindow {
 protected:
  CompareInWindow() {
    window.docks().show("compare");
    settle();
  }
  QString cell(int row, int column) {
    return window.docks().compare().table()->model()->index(row, column).data().toString();
  }
};

TEST_F(CompareInWindow, TheBeginningIsComparedWithTheChosenTime) {
  ASSERT_EQ(window.docks().compare().table()->model()->rowCount(), 3);
  EXPECT_EQ(cell(0, 0) + " " + cell(0, 1) + " " + cell(0, 3), "appeared object_3 counter_1");
  EXPECT_TRUE(cell(1, 0).startsWith("moved ") && cell(1, 0).endsWith("m")) << "with the distance";
  EXPECT_EQ(cell(1, 1) + " " + cell(1, 2) + " " + cell(1, 3), "object_2 counter_1 table_1");
  EXPECT_EQ(cell(2, 0) + " " + cell(2, 1), "gone object_1");
  click(window.docks().compare().table()->viewport(),
        window.docks()
            .compare()
            .table()
            ->visualRect(window.docks().compare().table()->model()->index(1, 1))
            .center());
  EXPECT_EQ(selection().object(), 2);
}

TEST_F(CompareInWindow, TitlesSayWhichTimeIsWhich) {
  const auto title = [&](int column) {
    return window.docks().compare().table()->model()->headerData(column, Qt::Horizontal).toString();
  };
  EXPECT_TRUE(title(2).startsWith("Other time\n")) << title(2).toStdString();
  EXPECT_TRUE(title(3).startsWith("Selected\n")) << title(3).toStdString();
}

TEST_F(CompareInWindow, TheOtherTimeCanBeTyped) {
  window.docks().compare().stamp()->setText("07:30");
  QTest::keyClick(window.docks().compare().stamp(), Qt::Key_Return);
  settle();
  EXPECT_EQ(window.docks().compare().other(), sample_.second);
  for (const Difference& difference : window.docks().compare().shown()) EXPECT_NE(difference.object, 2);
  go_to(sample_.second);
  EXPECT_TRUE(window.docks().compare().shown().empty());
}

TEST_F(CompareInWindow, BothMapsAreSeenByTheSameEyeWithWhatDiffersMarked) {
  EXPECT_FALSE(window.maps().is_pair());
  window.docks().compare().beside_box()->setChecked(true);
  settle();
  ASSERT_TRUE(window.maps().is_pair());
  MapView& then = *window.maps().then();
  EXPECT_EQ(window.maps().then_browser().belief().time, sample_.first);
  EXPECT_EQ(then.scene().objects().size(), 2U) << "cup and box on the counter";
  for (const MapObject& object : then.scene().objects()) EXPECT_TRUE(object.mark.has_value());
  ASSERT_NE(drawn(3), nullptr);
  EXPECT_TRUE(drawn(3)->mark.has_value()) << "the tin appeared";
  window.map().look_from(MapViewpoint::top);
  EXPECT_EQ(then.scene().eye(), window.map().scene().eye());
  choose(2);
  EXPECT_EQ(then.scene().selected_object(), 2);
  window.maps().then_browser().selection().select_object(1);
  settle();
  EXPECT_EQ(selection().object(), 1);
  window.docks().compare().beside_box()->setChecked(false);
  settle();
  EXPECT_FALSE(window.maps().is_pair());
  EXPECT_FALSE(drawn(3)->mark.has_value());
}

TEST_F(CompareInWindow, AnotherMemoryStandsBesideWithItsOwnNumbers) {
  window.docks().compare().compare_with(QString::fromStdString(sample_.path.string()));
  window.docks().compare().beside_box()->setChecked(true);
  settle();
  ASSERT_TRUE(window.maps().is_pair());
  EXPECT_EQ(window.maps().then_browser().belief().time, sample_.third);
  choose(2);
  EXPECT_EQ(window.maps().then()->scene().selected_object(), 2);
  window.show_data(nullptr);
  settle();
  EXPECT_FALSE(window.maps().is_pair());
}

}  // namespace
}  // namespace loci::gui
