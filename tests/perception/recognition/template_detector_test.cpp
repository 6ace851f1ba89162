#include "perception/recognition/template_detector.h"
#include "mapping/base/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci::perception {
namespace {

/// A table with a disc or a block on it, nearer than the table.
struct Shown {
  cv::Mat color{480, 640, CV_8UC3, cv::Scalar(60, 60, 60)}, depth{480, 640, CV_32F, cv::Scalar(1.0)},
      mask = cv::Mat::zeros(480, 640, CV_8U);

  void put(bool disc, const cv::Point& at, int size) {
    const auto draw = [&](cv::Mat& on, const cv::Scalar& value) {
      if (disc)
        cv::circle(on, at, size, value, cv::FILLED);
      else
        cv::rectangle(on, at - cv::Point(size, size / 2), at + cv::Point(size, size / 2), value, cv::FILLED);
    };
    draw(color, cv::Scalar(30, 200, 240));
    draw(mask, cv::Scalar(255));
    for (int v = 0; v < depth.rows; ++v)  // It leans, so that it has a normal of its own.
      for (int u = 0; u < depth.cols; ++u)
        if (mask.at<unsigned char>(v, u) > 0 && depth.at<float>(v, u) > 0.99f)
          depth.at<float>(v, u) = 0.9f + 0.0005f * static_cast<float>(u - at.x);
  }
};

TemplateDetector learned() {
  TemplateDetector detector;
  Shown disc, block;
  disc.put(true, {300, 200}, 60);
  block.put(false, {320, 240}, 70);
  EXPECT_GT(detector.add("disc", disc.color, disc.depth, disc.mask), 0);
  EXPECT_GT(detector.add("block", block.color, block.depth, block.mask), 0);
  return detector;
}

TEST(TemplateDetector, finds_what_it_was_shown_elsewhere_and_nearly_as_large) {
  Shown scene;
  scene.put(true, {150, 300}, 54);
  scene.put(false, {480, 160}, 70);
  const auto matches = learned().detect(scene.color, scene.depth, {});
  ASSERT_EQ(matches.size(), 2u);
  for (const TemplateMatch& match : matches) {
    const cv::Point at = match.name == "disc" ? cv::Point(150, 300) : cv::Point(480, 160);
    const cv::Point middle = (match.region.tl() + match.region.br()) / 2;
    EXPECT_LT(cv::norm(middle - at), 12) << match.name;
  }
  EXPECT_NE(matches[0].name, matches[1].name);
}

TEST(TemplateDetector, finds_nothing_on_an_empty_table_and_learns_nothing_from_nothing) {
  const Shown empty;
  EXPECT_TRUE(learned().detect(empty.color, empty.depth, {}).empty());
  TemplateDetector detector;
  EXPECT_EQ(detector.add("nothing", empty.color, empty.depth, empty.mask), 0);
  EXPECT_TRUE(detector.detect(empty.color, empty.depth, {}).empty());
  EXPECT_THROW(learned().detect(empty.color, cv::Mat(240, 320, CV_32F), {}), Error);
}

TEST(TemplateDetector, takes_images_of_any_size) {
  Shown scene;
  scene.put(true, {150, 200}, 60);
  const cv::Rect part(0, 0, 333, 301);
  const auto matches = learned().detect(scene.color(part), scene.depth(part), {});
  ASSERT_FALSE(matches.empty());
  EXPECT_EQ(matches[0].name, "disc");
}

TEST(TemplateDetector, answers_the_same_after_saving_and_refuses_other_files) {
  Shown scene;
  scene.put(true, {150, 300}, 60);
  const TemplateDetector detector = learned();
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path path = folder.path() / "templates";
  detector.save(path);
  const TemplateDetector loaded = TemplateDetector::load(path);
  EXPECT_EQ(loaded.templates(), detector.templates());
  const auto before = detector.detect(scene.color, scene.depth, {}),
             after = loaded.detect(scene.color, scene.depth, {});
  ASSERT_EQ(before.size(), after.size());
  for (size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i].region, after[i].region);
  for (const char* text : {"", "no templates", "%YAML:1.0\n---\na: 3\n"}) {
    write_file_atomically(path, text);
    EXPECT_THROW(TemplateDetector::load(path), Error) << text;
  }
}

}  // namespace
}  // namespace loci::perception
