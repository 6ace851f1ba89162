// What one does to the map to see more of it: the way of an object, measuring, a section, joints.

#include <QComboBox>
#include <QLabel>
#include <QSlider>
#include <QToolButton>

#include "gui/views/map/map_tools.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

class MapToolsInWindow : public test::BrowserWindow {
 protected:
  MapToolsInWindow() : test::BrowserWindow(MapBackend::memory) {
    window.docks().show("tools3d");
    settle();
  }
  MapTools& tools() { return window.docks().map_tools(); }
  QImage image() { return window.map().image(); }
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

TEST_F(MapToolsInWindow, TheChosenObjectIsDrawnWithThePointsThatWereKeptOfIt) {
  const MapScene& scene = window.map().scene();
  EXPECT_EQ(scene.object_point_count(), 0U) << "nothing is chosen";
  go_to(sample_.second);
  choose(2);
  const size_t kept = scene.object_point_count();
  go_to(sample_.third);
  EXPECT_EQ(scene.object_point_count(), kept) << "as it was seen last";
  go_to(sample_.first);
  const size_t coarse = scene.object_point_count();
  EXPECT_GT(coarse, 20U) << "from the depth thumbnail, a quarter as wide and high";
  EXPECT_GT(kept, 5 * coarse);
  go_to(sample_.third);
  choose(1);
  EXPECT_EQ(scene.object_point_count(), 0U) << "it is gone";
  choose(3);
  EXPECT_GT(scene.object_point_count(), 0U);
  selection().clear();
  settle();
  EXPECT_EQ(scene.object_point_count(), 0U);
}

TEST_F(MapToolsInWindow, PointsOfAnObjectLieOnItInItsColour) {
  const ColoredCloud cloud = window.browser().data()->object_cloud(2, sample_.second);
  size_t on_it = 0, blue = 0;
  const Eigen::AlignedBox3f box(Eigen::Vector3f(1.94F, 0.66F, 0.74F), Eigen::Vector3f(2.06F, 0.74F, 0.96F));
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    if (!box.contains(cloud.points[i])) continue;
    ++on_it;
    blue += cloud.colors[i][2] > cloud.colors[i][0];
  }
  EXPECT_GT(on_it, cloud.points.size() / 2) << "the mask is an ellipse about it";
  EXPECT_GT(blue, on_it * 9 / 10);
  EXPECT_TRUE(window.browser().data()->object_cloud(2, sample_.first - kSecond).points.empty());
}

TEST_F(MapToolsInWindow, MeasuresBetweenTwoClicksAndSelectsNothingMeanwhile) {
  window.map().look_from(MapViewpoint::front);
  image();
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
  const double distance = tools().measured()->text().section(' ', 0, 0).toDouble();
  EXPECT_NEAR(distance, (at(one) - at(other)).norm(), 0.002);
  tools().ruler()->click();
  EXPECT_FALSE(tools().measured()->text().contains("apart"));
}

TEST_F(MapToolsInWindow, ASectionCutsTheMapOpenAndGoesAgain) {
  const QImage whole = image();
  EXPECT_FALSE(tools().section_at()->isEnabled());
  tools().section()->setCurrentIndex(3);
  EXPECT_TRUE(tools().section_at()->isEnabled());
  tools().section_at()->setValue(20);
  const QImage cut = image();
  EXPECT_NE(cut, whole);
  tools().section()->setCurrentIndex(0);
  EXPECT_EQ(image(), whole);
}

TEST_F(MapToolsInWindow, WhatIsCutAwayIsNotMeasured) {
  window.map().look_from(MapViewpoint::top);
  image();
  const int x = window.map().canvas().width() / 2, y = window.map().canvas().height() / 2;
  const auto floor_or_table = window.map().scene().pick_point(x, y);
  ASSERT_TRUE(floor_or_table.has_value());
  window.map().set_section(MapSection{2, -10, true});
  image();
  EXPECT_FALSE(window.map().scene().pick_point(x, y).has_value());
}

TEST_F(MapToolsInWindow, ADrawerIsOpenedByHandUntilAnotherTimeIsChosen) {
  QSlider* drawer = tools().slider("drawer_2_front_joint");
  ASSERT_NE(drawer, nullptr);
  EXPECT_EQ(drawer->value(), drawer->minimum()) << "closed at the end";
  const QImage closed = image();
  drawer->setValue(drawer->maximum());
  EXPECT_GT(window.map().joints().at("drawer_2_front_joint"), 0.2);
  EXPECT_NE(image(), closed);
  go_to(sample_.second);
  EXPECT_NEAR(window.map().joints().at("drawer_2_front_joint"), 0.35, 1e-9) << "as it was believed then";
  EXPECT_GT(drawer->value(), drawer->minimum());
  go_to(sample_.third);
  EXPECT_FALSE(window.map().joints().contains("drawer_2_front_joint"));
}

TEST_F(MapToolsInWindow, AllCamerasAreALayerThatIsOffAtFirst) {
  EXPECT_FALSE(window.map().scene().layer(MapLayer::cameras));
  const QImage before = image();
  window.map().set_layer(MapLayer::cameras, true);
  EXPECT_NE(image(), before);
}

}  // namespace
}  // namespace loci::gui
