#include "perception/detection/lift.h"

#include <gtest/gtest.h>

#include <limits>

namespace loci::perception {
namespace {

/// A camera 1 m above a table that looks straight down at a box, 20 x 20 pixels and 10 cm high.
class Lift : public testing::Test {
 protected:
  Lift() {
    camera_.depth = {160, 120, 200, 200, 80, 60};
    camera_.color = camera_.depth;
    depth_ = cv::Mat(120, 160, CV_32F, cv::Scalar(1.0));
    depth_(object_) = 0.9;
  }

  LiftFrame frame(const cv::Mat& explained = {}) const {
    return lift_frame(depth_, camera_, explained, Vector3d(0, 0, -1));
  }
  static ImageRegion box(double x, double y, double width, double height) {
    ImageRegion region;
    region.box = {x, y, width, height};
    return region;
  }

  mapping::RgbdCamera camera_;
  cv::Mat depth_;
  const cv::Rect object_{60, 50, 20, 20};
};

TEST_F(Lift, BoxGivesTheObjectWithoutTheTable) {
  const LiftResult result = lift_region(frame(), box(57, 47, 26, 26));
  ASSERT_TRUE(result.region);
  EXPECT_EQ(result.region->pixels.size(), 400U);
  EXPECT_FALSE(result.region->at_image_border);
}

TEST_F(Lift, BackgroundFartherAwayIsLeftOut) {
  depth_.setTo(2.5);
  depth_(object_) = 0.9;
  EXPECT_EQ(lift_region(frame(), box(50, 40, 40, 40)).region->pixels.size(), 400U);
}

TEST_F(Lift, RegionsOfALargerImageAreScaled) {
  ImageRegion region = box(57 * 4, 47 * 4, 26 * 4, 26 * 4);
  region.image = {640, 480};
  EXPECT_EQ(lift_region(frame(), region).region->pixels.size(), 400U);
}

TEST_F(Lift, ColourCameraBesideTheDepthCamera) {
  camera_.depth_from_color.translation().x() = 0.045;  // 10 pixels at 0.9 m
  const LiftResult result = lift_region(frame(), box(50, 50, 20, 20));
  ASSERT_TRUE(result.region);
  EXPECT_NEAR(static_cast<double>(result.region->pixels.size()), 400, 25);
  EXPECT_EQ(lift_region(frame(), box(75, 55, 12, 12)).region->pixels.size(), 144U);  // the table
}

TEST_F(Lift, WhyNothingIsLifted) {
  EXPECT_EQ(lift_region(frame(), box(500, 50, 20, 20)).reason, Reason::outside_image);
  cv::Mat map_depth(120, 160, CV_32F, cv::Scalar(1.0));
  EXPECT_EQ(lift_region(frame(explained_by(depth_, map_depth)), box(100, 80, 20, 20)).reason,
            Reason::map_explained);
  depth_(object_) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(lift_region(frame(), box(60, 50, 20, 20)).reason, Reason::no_depth_inside);
}

TEST_F(Lift, MapLeavesTheObject) {
  cv::Mat map_depth(120, 160, CV_32F, cv::Scalar(1.0));
  const LiftResult result = lift_region(frame(explained_by(depth_, map_depth)), box(50, 40, 40, 40));
  ASSERT_TRUE(result.region);
  EXPECT_EQ(result.region->pixels.size(), 400U);
}

TEST_F(Lift, KeyPointsTakeTheDepthOfTheObject) {
  const LiftResult result = lift_region(frame(), box(57, 47, 26, 26), {{"corner", 61, 51}, {"off", 10, 10}});
  ASSERT_EQ(result.region->key_points.size(), 1U);
  const Vector3d position = result.region->key_points[0].position;
  EXPECT_NEAR(position.z(), 0.9, 1e-6);
  EXPECT_NEAR(position.x(), (60.5 - 80) / 200 * 0.9, 0.005);
}

}  // namespace
}  // namespace loci::perception
