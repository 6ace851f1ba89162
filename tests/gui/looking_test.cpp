// Values under the cursor, annotations of images, filters, files.

#include <QComboBox>
#include <QTreeWidget>
#include <cstdlib>

#include "gui/data/differences.h"
#include "gui/data/exports.h"
#include "gui/data/scene_content.h"
#include "gui/models/objects_model.h"
#include "gui/views/compare_view.h"
#include "gui/views/scene_view.h"
#include "mapping/base/text/json.h"
#include "memory/report/memory_statistics.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

/// A wall two metres before both cameras, which stand side by side.
SceneContent wall() {
  SceneContent content;
  content.camera.depth = {640, 480, 500, 500, 320, 240};
  content.camera.color = {1280, 960, 1000, 1000, 640, 480};
  content.camera.depth_from_color = Isometry3d(Eigen::Translation3d(0.05, 0, 0));
  content.depth = cv::Mat(120, 160, CV_32F, cv::Scalar(2));
  content.color = cv::Mat(960, 1280, CV_8UC3, cv::Scalar(10, 20, 30));
  content.map_from_camera = Isometry3d(Eigen::Translation3d(1, 0, 0));
  return content;
}

TEST(PixelValues, OfADepthPixelAreItsPointInTheMap) {
  const PixelValues values = values_at_depth(wall(), {320, 240});
  ASSERT_TRUE(values.depth && values.position && values.color);
  EXPECT_NEAR(*values.depth, 2, 1e-6);
  EXPECT_NEAR((*values.position - Vector3d(1, 0, 2)).norm(), 0, 1e-6);
  EXPECT_EQ((*values.color)[0], 30);
}

TEST(PixelValues, OfAColourPixelTakeTheCamerasOffsetIntoAccount) {
  const PixelValues values = values_at_color(wall(), {640, 480});
  ASSERT_TRUE(values.position.has_value());
  EXPECT_NEAR((*values.position - Vector3d(1.05, 0, 2)).norm(), 0, 1e-6);
  EXPECT_FALSE(values_at_color(wall(), {-500, 480}).position.has_value());
}

TEST(PixelKinds, OfTheColourImageAreThoseOfTheSamePlaces) {
  SceneContent content = wall();
  EXPECT_TRUE(kinds_in_color(content).empty()) << "not known";
  content.kinds = cv::Mat(content.depth.size(), CV_8U,
                          cv::Scalar(static_cast<uint8_t>(mapping::PixelKind::map_explained)));
  content.kinds.colRange(80, 160) = static_cast<uint8_t>(mapping::PixelKind::region_of_interest);
  const cv::Mat seen = kinds_in_color(content);
  ASSERT_EQ(seen.size(), content.depth.size());
  // The colour camera is 5 cm to the right, so the border is 25 mm / 2 m * 1000 px = 25 of 1280 px further
  // left.
  const auto border = static_cast<int>((640 - 25) * 160 / 1280);
  EXPECT_EQ(seen.at<uint8_t>(60, border - 4), static_cast<uint8_t>(mapping::PixelKind::map_explained));
  EXPECT_EQ(seen.at<uint8_t>(60, border + 4), static_cast<uint8_t>(mapping::PixelKind::region_of_interest));
}

TEST(ImageNotes, AreWhatHasARegionInTheImage) {
  const auto notes = notes_in(R"({"structures": [
    {"id": "#1", "type": "loci.annotation.LogoAnnotation",
     "features": {"name": "Milka", "source": "VisualSearch", "roi": "#2"}},
    {"id": "#2", "type": "loci.cv.Rect", "features": {"x": 4, "y": 5, "width": 60, "height": 30}},
    {"id": "#3", "type": "loci.annotation.BarcodeAnnotation", "features": {"code": "40017",
     "roi": {"id": "#4", "type": "loci.cv.Rect", "features": {"x": 1, "y": 2, "width": 3, "height": 4}}}},
    {"id": "#5", "type": "loci.annotation.ColorAnnotation", "features": {"text": "red"}}]})");
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].text, "Milka");
  EXPECT_EQ(notes[0].annotator, "VisualSearch");
  EXPECT_EQ(notes[0].region, cv::Rect2d(4, 5, 60, 30));
  EXPECT_EQ(notes[1].type, "BarcodeAnnotation");
  EXPECT_EQ(notes[1].region.width, 3);
}

TEST(AnotherMemory, IsRenumberedByPlaceAndColour) {
  const auto believed = [](int64_t id, double x, const char* color) {
    BelievedObject object;
    object.object = id;
    object.color = color;
    object.position = Vector3d(x, 0, 0);
    return object;
  };
  const Belief here{0, {believed(1, 0, "red"), believed(2, 1, "blue")}};
  const Belief there{0, {believed(7, 1.1, "blue"), believed(8, 0.1, "blue"), believed(9, 0.2, "red")}};
  const Belief same = renumbered(there, here);
  EXPECT_EQ(same.objects[0].object, 2);
  EXPECT_LT(same.objects[1].object, 0);
  EXPECT_EQ(same.objects[2].object, 1);
}

using test::BrowserWindow;

TEST_F(BrowserWindow, ValuesUnderTheCursorAreTold) {
  go_to(sample_.first);
  const auto box = window.docks().image().box_of(2);
  ASSERT_TRUE(box.has_value());
  EXPECT_TRUE(window.docks().image().values_at(box->center()).contains(" m · rgb"))
      << window.docks().image().values_at(box->center()).toStdString();
  EXPECT_TRUE(window.docks().image().values_at(box->center()).contains("map"));
  EXPECT_TRUE(window.docks().image().values_at(QPointF(-5, -5)).isEmpty());
}

TEST_F(BrowserWindow, WhatBelongsToAThingIsOutlinedInBothImages) {
  go_to(sample_.first);
  const auto content = window.browser().moment().content;
  ASSERT_FALSE(content->boxes.empty());
  for (const ImageBox& box : content->boxes) {
    ASSERT_EQ(box.color_outline.size(), 1U);
    for (const auto& [outline, area] :
         {std::pair(box.color_outline[0], box.color), std::pair(box.depth_outline[0], box.depth)})
      for (const cv::Point2f& pixel : outline)
        EXPECT_TRUE(cv::Rect2d(area.x - 1, area.y - 1, area.width + 2, area.height + 2).contains(pixel));
  }
  const QImage with = window.docks().image().grab().toImage();
  window.docks().image().show_masks(false);
  EXPECT_NE(window.docks().image().grab().toImage(), with);
}

TEST_F(BrowserWindow, WhatIsKnownAndOfInterestIsTinted) {
  const cv::Mat& kinds = window.browser().moment().content->kinds;
  ASSERT_FALSE(kinds.empty());
  EXPECT_EQ(kinds.at<uint8_t>(0, 0), static_cast<uint8_t>(mapping::PixelKind::map_explained));
  EXPECT_EQ(kinds.at<uint8_t>(kinds.rows - 1, 0),
            static_cast<uint8_t>(mapping::PixelKind::region_of_interest));
  const QImage plain = window.docks().image().grab().toImage();
  press(Qt::Key_I);
  EXPECT_NE(window.docks().image().grab().toImage(), plain);
  press(Qt::Key_I);
  EXPECT_EQ(window.docks().image().grab().toImage(), plain);
}

TEST_F(BrowserWindow, WhatWasFoundInTheImageStandsBesideIt) {
  EXPECT_TRUE(window.docks().scene_view().notes()->isHidden()) << "nothing was found: no empty tree";
  ImageNote note{"LogoAnnotation", "Milka", "VisualSearch", -1, {100, 100, 200, 100}};
  window.docks().scene_view().show_notes({note});
  const QTreeWidget* tree = window.docks().scene_view().notes();
  ASSERT_EQ(tree->topLevelItemCount(), 1);
  EXPECT_EQ(tree->topLevelItem(0)->text(0), "Logo");
  EXPECT_EQ(tree->topLevelItem(0)->child(0)->text(0), "Milka");
  const QImage before = window.docks().image().grab().toImage();
  window.docks().scene_view().notes()->setCurrentItem(tree->topLevelItem(0)->child(0));
  EXPECT_NE(window.docks().image().grab().toImage(), before) << "its box is marked";
}

TEST_F(BrowserWindow, TheTreeShowsOnlyWhatIsOfTheChosenColour) {
  go_to(sample_.first);
  const std::string color = window.browser().belief().find(1)->color.value();
  QComboBox* box = window.docks().tree().filter(ObjectsFilter::color_field);
  box->showPopup();
  box->hidePopup();
  const int index = box->findText(QString::fromStdString(color));
  ASSERT_GT(index, 0) << color;
  box->setCurrentIndex(index);
  Q_EMIT box->activated(index);
  settle();
  EXPECT_TRUE(window.docks().tree().shown_index_of_object(1).isValid());
  for (const BelievedObject& object : window.browser().belief().objects)
    EXPECT_EQ(window.docks().tree().shown_index_of_object(object.object).isValid(), object.color == color);
  QApplication::setActiveWindow(&window);
  press(Qt::Key_Escape);
  EXPECT_TRUE(window.docks().tree().shown_index_of_object(2).isValid()) << "Esc shows all again";
}

TEST_F(BrowserWindow, ThumbnailsStandInTheTreeOnceTheyAreRead) {
  const auto side = [this] {
    const QModelIndex index = window.docks().tree().model()->index_of_object(2);
    return index.data(Qt::DecorationRole).value<QPixmap>().width();
  };
  side();
  settle();
  EXPECT_GT(side(), 14) << "an image, larger than the swatch of its colour";
}

TEST_F(BrowserWindow, AMemoryComparedWithItselfHasNoDifferences) {
  window.docks().show("compare");
  settle();
  ASSERT_FALSE(window.docks().compare().shown().empty()) << "two times differ";
  window.docks().compare().compare_with(QString::fromStdString(sample_.path.string()));
  settle();
  EXPECT_TRUE(window.docks().compare().shown().empty());
  EXPECT_EQ(window.docks().compare().source()->currentText(), "sample.loci");
}

TEST_F(BrowserWindow, WhatIsBelievedCanBeWrittenAsATable) {
  const std::string csv = believed_csv(window.browser().belief());
  EXPECT_NE(csv.find("object_2,"), std::string::npos);
  const Json json = parse_json(believed_json(window.browser().belief()), "test");
  EXPECT_EQ(json["objects"].size(), window.browser().belief().objects.size());
  const std::string ply = cloud_ply(*window.browser().moment().cloud);
  EXPECT_NE(ply.find("element vertex " + std::to_string(window.browser().moment().cloud->points.size())),
            std::string::npos);
}

TEST_F(BrowserWindow, AnnotatorsAreListedByTheirTimes) {
  write_json(folder_.path / "sample.statistics.json",
             Json{{"version", 1},
                  {"annotators",
                   {{"Fast", {{"scenes", 10}, {"seconds", 0.01}}},
                    {"Slow", {{"scenes", 10}, {"seconds", 1.0}, {"failures", 2}}}}}});
  const auto times = memory::annotator_times(sample_.path);
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[0].name, "Slow");
  EXPECT_NEAR(times[0].ms_per_scene(), 100, 1e-9);
  EXPECT_EQ(times[0].failures, 2);
}

}  // namespace
}  // namespace loci::gui
