#include "mapping/sensor/kinect.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace loci::mapping {
namespace {

/// A wall across the optical axis at z.
cv::Mat wall(double z) {
  return {480, 640, CV_32F, cv::Scalar(z)};
}

cv::Mat facing() {
  return {480, 640, CV_32FC3, cv::Scalar(0, 0, -1)};
}

int measured_count(const cv::Mat& depth) {
  return cv::countNonZero(depth == depth);
}

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

TEST(Kinect, PinnedNumbersAreTheDefaults) {
  const KinectModel model;
  const RgbdCamera camera = kinect_camera();
  EXPECT_EQ(camera.depth.fx, 585);
  EXPECT_EQ(camera.color.fx, 528);
  EXPECT_EQ(camera.depth_from_color.translation().x(), 0.022);
  EXPECT_EQ(model.baseline_m, 0.075);
  EXPECT_EQ(model.disparity_sigma_px, 0.1);
  EXPECT_EQ(model.disparity_step_px, 0.125);
  EXPECT_EQ(model.distortion_per_m, 0.003);
  EXPECT_EQ(model.incidence_max_deg, 75);
  EXPECT_EQ(model.edge_probability, 0.5);
  EXPECT_EQ(model.range_min_m, 0.5);
  EXPECT_EQ(model.range_max_m, 5);
}

TEST(Kinect, NoiseOfTheDisparityIsThatOfSigmaAndStep) {
  KinectModel model;
  model.distortion_per_m = 0;
  const double focal_times_baseline = 585 * 0.075;
  for (const double z : {1.0, 1.7, 3.1}) {
    const cv::Mat depth = measured_by_kinect(wall(z), facing(), kinect_camera().depth, model, Random(1));
    double sum = 0, squares = 0;
    int count = 0;
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        const double measured = static_cast<double>(depth.at<float>(v, u));
        if (std::isnan(measured)) continue;
        const double disparity = focal_times_baseline / measured;
        EXPECT_NEAR(disparity * 8, std::round(disparity * 8), 1e-3);
        const double error = disparity - focal_times_baseline / z;
        sum += error;
        squares += error * error;
        ++count;
      }
    }
    const double mean = sum / count;
    const double expected = std::sqrt(0.1 * 0.1 + 0.125 * 0.125 / 12);  // Noise, then uniform rounding.
    EXPECT_NEAR(mean, 0, 0.005) << z;
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean), expected, 0.05 * expected) << z;
  }
}

TEST(Kinect, DistortionIsFixedAndGrowsWithTheSquareOfDepth) {
  KinectModel model;
  model.disparity_sigma_px = 0;
  model.disparity_step_px = 0;
  const PinholeCamera camera = kinect_camera().depth;
  double largest = 0;
  for (const double z : {1.0, 3.0}) {
    const cv::Mat depth = measured_by_kinect(wall(z), facing(), camera, model, Random(1));
    EXPECT_TRUE(same_bytes(depth, measured_by_kinect(wall(z), facing(), camera, model, Random(2))));
    for (int v = 5; v < 480; v += 37)
      for (int u = 90; u < 640; u += 41)
        EXPECT_NEAR(static_cast<double>(depth.at<float>(v, u)),
                    z + 0.003 * z * z * distortion_field(camera, u, v), 1e-6);
  }
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) largest = std::max(largest, std::abs(distortion_field(camera, u, v)));
  EXPECT_LE(largest, 1);
  EXPECT_GT(largest, 0.8);
}

TEST(Kinect, NothingOutsideRangeOrBeyondTheIncidence) {
  const KinectModel model;
  const PinholeCamera camera = kinect_camera().depth;
  EXPECT_EQ(measured_count(measured_by_kinect(wall(0.4), facing(), camera, model, Random(1))), 0);
  EXPECT_EQ(measured_count(measured_by_kinect(wall(5.5), facing(), camera, model, Random(1))), 0);
  // A surface whose normal is 80 degrees off the axis, looked at along the axis.
  const double angle = 80 * kPi / 180;
  const cv::Mat slanted(480, 640, CV_32FC3, cv::Scalar(0, std::sin(angle), -std::cos(angle)));
  const cv::Mat depth = measured_by_kinect(wall(2), slanted, camera, model, Random(1));
  EXPECT_TRUE(std::isnan(depth.at<float>(240, 320)));
}

/// A near square before a wall.
cv::Mat step() {
  cv::Mat depth = wall(2);
  depth(cv::Rect(300, 100, 200, 200)) = 1.0;
  return depth;
}

TEST(Kinect, HalfIsMissingWithinTwoPixelsOfAnEdge) {
  KinectModel model;
  model.shadow = false;
  const cv::Mat depth = measured_by_kinect(step(), cv::Mat(), kinect_camera().depth, model, Random(3));
  int missing = 0, band = 0;
  for (int v = 110; v < 290; ++v) {
    for (const int u : {298, 299, 300, 301, 498, 499, 500, 501}) {
      missing += std::isnan(depth.at<float>(v, u)) ? 1 : 0;
      ++band;
    }
    EXPECT_FALSE(std::isnan(depth.at<float>(v, 297)));
    EXPECT_FALSE(std::isnan(depth.at<float>(v, 302)));
  }
  EXPECT_NEAR(static_cast<double>(missing) / band, 0.5, 0.05);
}

TEST(Kinect, ShadowIsLeftOfTheNearSurfaceAndAsWideAsTheDisparitySays) {
  KinectModel model;
  model.edge_probability = 0;
  const cv::Mat depth = measured_by_kinect(step(), cv::Mat(), kinect_camera().depth, model, Random(3));
  int missing = 0;
  for (int u = 200; u < 300; ++u) missing += std::isnan(depth.at<float>(200, u)) ? 1 : 0;
  EXPECT_NEAR(missing, 585 * 0.075 * (1 / 1.0 - 1 / 2.0), 1.5);
  EXPECT_TRUE(std::isnan(depth.at<float>(200, 298)));
  for (int u = 500; u < 600; ++u) EXPECT_FALSE(std::isnan(depth.at<float>(200, u)));
}

TEST(Kinect, SameSeedSameBytesOnAnyNumberOfThreads) {
  const KinectModel model;
  const PinholeCamera camera = kinect_camera().depth;
  const cv::Mat one = measured_by_kinect(step(), cv::Mat(), camera, model, Random(7), 1);
  EXPECT_TRUE(same_bytes(one, measured_by_kinect(step(), cv::Mat(), camera, model, Random(7), 3)));
  EXPECT_FALSE(same_bytes(one, measured_by_kinect(step(), cv::Mat(), camera, model, Random(8), 1)));
  cv::Mat a(480, 640, CV_8UC3, cv::Scalar(100, 100, 100)), b = a.clone();
  add_color_noise(a, model, Random(7), 1);
  add_color_noise(b, model, Random(7), 2);
  EXPECT_TRUE(same_bytes(a, b));
  cv::Scalar mean, deviation;
  cv::meanStdDev(a, mean, deviation);
  EXPECT_NEAR(deviation[0], 3, 0.05);
}

}  // namespace
}  // namespace loci::mapping
