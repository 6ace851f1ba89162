#include "perception/conversions/opencv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "perception/cas/json.h"

namespace loci::perception::types {
namespace {

cv::Mat counting(int rows, int cols, int type) {
  cv::Mat image(rows, cols, type);
  for (size_t i = 0; i < image.total() * image.elemSize(); ++i) image.data[i] = static_cast<uint8_t>(i * 7);
  return image;
}

bool equal(const cv::Mat& one, const cv::Mat& two) {
  return one.size() == two.size() && one.type() == two.type() &&
         std::memcmp(one.data, two.data, one.total() * one.elemSize()) == 0;
}

TEST(MatConversion, SharesMemoryBothWays) {
  cas::Cas cas(type_system());
  const cv::Mat image = counting(48, 64, CV_8UC3);
  const Mat mat = to(cas, image);
  EXPECT_EQ(mat.data.get().data(), image.data);
  EXPECT_EQ(from<cv::Mat>(mat).data, image.data);
  EXPECT_TRUE(equal(from<cv::Mat>(mat), image));
}

TEST(MatConversion, ImagesOutliveTheirCas) {
  cv::Mat kept;
  const cv::Mat expected = counting(5, 7, CV_32FC1);
  {
    cas::Cas cas(type_system());
    kept = from<cv::Mat>(to(cas, expected.clone()));
  }
  EXPECT_TRUE(equal(kept, expected));
  const cv::Mat again = kept;
  kept = cv::Mat();
  EXPECT_TRUE(equal(again, expected));
}

TEST(MatConversion, CopiesPartsAndMemoryOfOthers) {
  cas::Cas cas(type_system());
  const cv::Mat image = counting(10, 10, CV_16UC1);
  const cv::Mat part = image(cv::Rect(2, 3, 4, 5));
  EXPECT_TRUE(equal(from<cv::Mat>(to(cas, part)), part.clone()));
  std::vector<uint8_t> memory(12, 9);
  const cv::Mat foreign(3, 4, CV_8UC1, memory.data());
  const Mat mat = to(cas, foreign);
  EXPECT_NE(mat.data.get().data(), memory.data());
}

TEST(MatConversion, ComesBackFromJson) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_32FC1, CV_64FC2}) {
    cas::Cas cas(type_system()), other(type_system());
    const cv::Mat image = counting(11, 13, type);
    const auto back = cas::from_json(other, cas::to_json(to(cas, image)));
    EXPECT_TRUE(equal(from<cv::Mat>(as<Mat>(back)), image));
  }
}

TEST(MatConversion, EmptyImagesComeBackEmpty) {
  cas::Cas cas(type_system());
  EXPECT_TRUE(from<cv::Mat>(to(cas, cv::Mat())).empty());
}

TEST(MatConversion, RefusesWhatDoesNotFit) {
  cas::Cas cas(type_system());
  EXPECT_THROW(from<cv::Mat>(Mat()), Error);
  const Mat mat = to(cas, counting(4, 4, CV_8UC1));
  mat.rows.set(5);
  EXPECT_THROW(from<cv::Mat>(mat), Error);
  mat.rows.set(-1);
  EXPECT_THROW(from<cv::Mat>(mat), Error);
  EXPECT_THROW(from<cv::Mat_<float>>(to(cas, counting(4, 4, CV_8UC1))), Error);
}

TEST(MatConversion, TypedImagesKeepTheirType) {
  cas::Cas cas(type_system());
  const cv::Mat_<float> depth(3, 4, 1.5F);
  EXPECT_EQ((from<cv::Mat_<float>>(to(cas, depth))(2, 3)), 1.5F);
}

TEST(MatConversion, ViewsGiveTheirImages) {
  cas::Cas cas(type_system());
  const SceneCas scene_cas(cas);
  const cv::Mat image = counting(4, 4, CV_8UC3);
  set_view_image(scene_cas, SceneCas::kColor, image);
  EXPECT_EQ(view_image(scene_cas, SceneCas::kColor).data, image.data);
  EXPECT_THROW(view_image(scene_cas, SceneCas::kDepth), Error);
}

std::vector<cv::Point2f> hull_of(const std::vector<cv::Point2f>& points) {
  std::vector<cv::Point2f> hull;
  cv::convexHull(points, hull);
  return hull;
}

TEST(NearHull, KeepsTheHull) {
  Random random(1);
  for (const float grid :
       {1e-6F, 0.01F, 0.2F})  // The coarser, the more points are in one place or on one edge.
    for (const size_t count : {1U, 2U, 9U, 400U}) {
      std::vector<cv::Point2f> points;
      for (size_t i = 0; i < count; ++i)
        points.emplace_back(grid * std::round(static_cast<float>(random.normal()) / grid),
                            grid * std::round(0.3F * static_cast<float>(random.normal()) / grid));
      EXPECT_EQ(hull_of(near_hull(points)), hull_of(points)) << grid << " " << count;
    }
  EXPECT_TRUE(near_hull({}).empty());
}

TEST(NearHull, LeavesOutMostOfADisc) {
  std::vector<cv::Point2f> disc;
  for (int u = -50; u <= 50; ++u)
    for (int v = -50; v <= 50; ++v)
      if (u * u + v * v <= 2500)
        disc.emplace_back(0.01F * static_cast<float>(u), 0.01F * static_cast<float>(v));
  EXPECT_LT(near_hull(disc).size(), disc.size() / 8);
}

TEST(RectConversion, ComesBack) {
  cas::Cas cas(type_system());
  const cv::Rect rect(1, 2, 3, 4);
  EXPECT_EQ(from<cv::Rect>(to(cas, rect)), rect);
}

}  // namespace
}  // namespace loci::perception::types
