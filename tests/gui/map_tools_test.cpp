// What one does to the map to see more of it: the way of an object, measuring, a section, joints.

#include <QComboBox>
#include <QLabel>
#include <QSlider>
#include <QToolButton>

#include "gui/views/map_tools.h"
#include "tests/gui/window_fixture.h"

namespace loci {
namespace {

class MapToolsInWindow : public test::BrowserWindow {
 protected:
  MapToolsInWindow() : BrowserWindow(MapBackend::memory) {
    window.show_dock("tools3d");
    settle();
  }
  MapTools& tools() { return window.map_tools(); }
  QImage picture() { return window.map().picture(); }
};

TEST_F(MapToolsInWindow, TheWayOfTheChosenObjectGoesUntilTheChosenTime) {
  choose(2);
  ASSERT_EQ(window.map().scene().trace().size(), 2U) << "counter, then table";
  EXPECT_NEAR((window.map().scene().trace()[1] - Vector3d(2.0, 0.7, 0.85)).norm(), 0, 1e-6);
  go_to(sample_.first);
  EXPECT_EQ(window.map().scene().trace().size(), 1U);
  selection().clear();
  settle();
  EXPECT_TRUE(window.map().scene().trace().empty());
}

TEST_F(MapToolsInWindow, MeasuresBetweenTwoClicksAndChoosesNothingMeanwhile) {
  window.map().look_from(MapViewpoint::front);
  picture();
  tools().ruler()->click();
  QWidget* canvas = &window.map().canvas();
  const QPoint one = canvas->rect().center() - QPoint(60, 0), other = canvas->rect().center() + QPoint(60, 0);
  click(canvas, one);
  EXPECT_TRUE(tools().measured()->text().startsWith("from ")) << tools().measured()->text().toStdString();
  click(canvas, other);
  EXPECT_TRUE(tools().measured()->text().contains(" m apart")) << tools().measured()->text().toStdString();
  EXPECT_FALSE(selection().object().has_value());
  EXPECT_TRUE(selection().place().empty());
  const double ratio = canvas->devicePixelRatioF();
  const auto at = [&](const QPoint& p) {
    return *window.map().scene().pick_point(static_cast<int>(p.x() * ratio),
                                            static_cast<int>((canvas->height() - 1 - p.y()) * ratio));
  };
  const double told = tools().measured()->text().section(' ', 0, 0).toDouble();
  EXPECT_NEAR(told, (at(one) - at(other)).norm(), 0.002);
  tools().ruler()->click();
  EXPECT_FALSE(tools().measured()->text().contains("apart"));
}

TEST_F(MapToolsInWindow, ASectionCutsTheMapOpenAndGoesAgain) {
  const QImage whole = picture();
  EXPECT_FALSE(tools().section_at()->isEnabled());
  tools().section()->setCurrentIndex(3);
  EXPECT_TRUE(tools().section_at()->isEnabled());
  tools().section_at()->setValue(20);
  const QImage cut = picture();
  EXPECT_NE(cut, whole);
  tools().section()->setCurrentIndex(0);
  EXPECT_EQ(picture(), whole);
}

TEST_F(MapToolsInWindow, WhatIsCutAwayIsNotMeasured) {
  window.map().look_from(MapViewpoint::top);
  picture();
  const int x = window.map().canvas().width() / 2, y = window.map().canvas().height() / 2;
  const auto floor_or_table = window.map().scene().pick_point(x, y);
  ASSERT_TRUE(floor_or_table.has_value());
  window.map().set_section(MapSection{2, -10, true});
  picture();
  EXPECT_FALSE(window.map().scene().pick_point(x, y).has_value());
}

TEST_F(MapToolsInWindow, ADrawerIsOpenedByHandUntilAnotherTimeIsChosen) {
  QSlider* drawer = tools().slider("drawer_2_front_joint");
  ASSERT_NE(drawer, nullptr);
  EXPECT_EQ(drawer->value(), drawer->minimum()) << "closed at the end";
  const QImage closed = picture();
  drawer->setValue(drawer->maximum());
  EXPECT_GT(window.map().joints().at("drawer_2_front_joint"), 0.2);
  EXPECT_NE(picture(), closed);
  go_to(sample_.second);
  EXPECT_NEAR(window.map().joints().at("drawer_2_front_joint"), 0.35, 1e-9) << "as it was believed then";
  EXPECT_GT(drawer->value(), drawer->minimum());
  go_to(sample_.third);
  EXPECT_FALSE(window.map().joints().contains("drawer_2_front_joint"));
}

TEST_F(MapToolsInWindow, AllCamerasAreALayerThatIsOffAtFirst) {
  EXPECT_FALSE(window.map().scene().layer(MapLayer::cameras));
  const QImage before = picture();
  window.map().set_layer(MapLayer::cameras, true);
  EXPECT_NE(picture(), before);
}

}  // namespace
}  // namespace loci
