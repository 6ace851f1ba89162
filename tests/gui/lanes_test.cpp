// The time line: lanes in three colours, zoom and scrub.

#include <QTest>
#include <QWheelEvent>

#include "gui/core/theme.h"
#include "gui/views/timeline/lane_view.h"
#include "gui/views/timeline/time_bar.h"
#include "gui/views/timeline/time_track.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

class LanesInWindow : public test::BrowserWindow {
 protected:
  LaneView& lanes() { return *window.docks().time_bar().lanes(); }
  TimeAxis& axis() { return window.docks().time_bar().axis(); }
  size_t lane_of(int64_t object, const std::string& place = {}) {
    for (size_t i = 0; i < lanes().lanes().size(); ++i)
      if (lanes().lanes()[i].object == object && lanes().lanes()[i].place == place) return i;
    ADD_FAILURE() << "no such lane";
    return 0;
  }
  QColor color_at(size_t lane, TimeNs time) {
    return lanes().viewport()->grab().toImage().pixelColor(lanes().point_of(lane, time) + QPoint(5, 3));
  }
};

TEST_F(LanesInWindow, ThereIsOneForEachObjectAndPlace) {
  EXPECT_EQ(lanes().lanes().size(), 5U);
  EXPECT_EQ(window.browser().data()->visibility_of_object(1),
            (std::vector<memory::ObjectStatus>{memory::ObjectStatus::seen, memory::ObjectStatus::out_of_view,
                                               memory::ObjectStatus::missed}));
  EXPECT_EQ(window.browser().data()->visibility_of_place("table_1"),
            (std::vector<memory::ObjectStatus>{memory::ObjectStatus::out_of_view, memory::ObjectStatus::seen,
                                               memory::ObjectStatus::out_of_view}));
}

TEST_F(LanesInWindow, SeenMissedAndNotObservedHaveColoursOfTheirOwn) {
  const Theme theme = Theme::of(window.palette());
  const size_t cup = lane_of(1);
  EXPECT_EQ(color_at(cup, sample_.first), theme.seen);
  EXPECT_EQ(color_at(cup, sample_.third), theme.gone);
  EXPECT_NE(color_at(cup, sample_.second), theme.seen);
  EXPECT_NE(color_at(cup, sample_.second), theme.gone);
}

TEST_F(LanesInWindow, AClickChoosesTimeAndObject) {
  click(lanes().viewport(), lanes().point_of(lane_of(2), sample_.second));
  EXPECT_EQ(selection().object(), 2);
  EXPECT_EQ(selection().time(), sample_.second);
  window.resize(1280, 1000);  // room for all lanes
  QTest::qWait(50);
  const size_t table = lane_of(0, "table_1");
  selection().select_place("table_1");
  selection().clear();
  click(lanes().viewport(), lanes().point_of(table, sample_.first));
  EXPECT_EQ(selection().place(), "table_1");
  EXPECT_EQ(selection().time(), sample_.first);
}

TEST_F(LanesInWindow, ZoomKeepsTheChosenTimeAndAllCanBeShownAgain) {
  go_to(sample_.second);
  const double before = window.docks().time_bar().track()->x_of(sample_.second);
  press(Qt::Key_Plus, Qt::ControlModifier);
  EXPECT_GT(axis().from(), sample_.first);
  EXPECT_NEAR(window.docks().time_bar().track()->x_of(sample_.second), before, 1);
  EXPECT_NEAR(lanes().point_of(0, sample_.second).x(), before, 1) << "lanes and track are in line";
  press(Qt::Key_Home);
  EXPECT_EQ(axis().from(), sample_.first) << "the selected time is always shown";
  press(Qt::Key_0, Qt::ControlModifier);
  EXPECT_EQ(axis().from(), sample_.first);
  EXPECT_EQ(axis().to(), sample_.third);
}

TEST(TimeAxis, PansAndZoomsOnlyWithinTheMemory) {
  TimeAxis axis;
  axis.set_whole(0, 1000 * kSecond);
  axis.zoom(0.5, 0);
  EXPECT_EQ(axis.from(), 0);
  EXPECT_EQ(axis.to(), 500 * kSecond);
  axis.pan(-1);
  EXPECT_EQ(axis.from(), 0);
  axis.pan(3);
  EXPECT_EQ(axis.to(), 1000 * kSecond);
  EXPECT_EQ(axis.from(), 500 * kSecond);
  axis.zoom(10, 700 * kSecond);
  EXPECT_EQ(axis.from(), 0);
  EXPECT_EQ(axis.to(), 1000 * kSecond);
  for (int i = 0; i < 200; ++i) axis.zoom(0.5, 300 * kSecond);
  EXPECT_GE(axis.to() - axis.from(), kSecond / 10);
}

}  // namespace
}  // namespace loci::gui
