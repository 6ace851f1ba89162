#include "mapping/recording/rectification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

const PinholeCamera kCamera{320, 240, 260, 260, 160, 120};

// Points from the documentation of OpenCV's models, computed here by their formulas: a ray at (0.5, 0.25).
TEST(Distortion, ModelsFollowTheirDefinition) {
  const Vector2d ray(0.5, 0.25);
  const double r2 = ray.squaredNorm();
  const auto plumb = distortion_from("plumb_bob", {0.1, -0.2, 0.01, 0.02, 0.05}, {});
  const double radial = 1 + 0.1 * r2 - 0.2 * r2 * r2 + 0.05 * r2 * r2 * r2;
  EXPECT_NEAR(plumb.distorted(ray).x(), 0.5 * radial + 2 * 0.01 * 0.125 + 0.02 * (r2 + 2 * 0.25), 1e-12);
  EXPECT_NEAR(plumb.distorted(ray).y(), 0.25 * radial + 0.01 * (r2 + 2 * 0.0625) + 2 * 0.02 * 0.125, 1e-12);
  const auto rational = distortion_from("rational_polynomial", {0.1, -0.2, 0, 0, 0.05, 0.3, 0.1, 0.2}, {});
  EXPECT_NEAR(rational.distorted(ray).x(), 0.5 * radial / (1 + 0.3 * r2 + 0.1 * r2 * r2 + 0.2 * r2 * r2 * r2),
              1e-12);
  const auto prism =
      distortion_from("rational_polynomial", {0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0.2, 0.3, 0.4, 0, 0}, {});
  EXPECT_NEAR(prism.distorted(ray).x(), 0.5 + 0.1 * r2 + 0.2 * r2 * r2, 1e-12);
  EXPECT_NEAR(prism.distorted(ray).y(), 0.25 + 0.3 * r2 + 0.4 * r2 * r2, 1e-12);
  const auto fisheye = distortion_from("equidistant", {0.1, 0, 0, 0}, {});
  const double angle = std::atan(std::sqrt(r2));
  EXPECT_NEAR(fisheye.distorted(ray).norm(), angle * (1 + 0.1 * angle * angle), 1e-12);
}

TEST(Distortion, UnknownModelsAndCountsAreRefused) {
  EXPECT_THROW(distortion_from("ftheta", {1}, {}), Error);
  EXPECT_THROW(distortion_from("plumb_bob", {1, 2, 3}, {}), Error);
  EXPECT_THROW(distortion_from("plumb_bob", {NAN, 2, 3, 4}, {}), Error);
  EXPECT_EQ(distortion_from("anything", {0, 0, 0, 0, 0}, {}).model, Distortion::Model::none);
}

/// A plane at 1.5 m with a step to 1 m in its middle, and stripes, as a lens with distortion sees it.
struct LensImage {
  cv::Mat depth{kCamera.height, kCamera.width, CV_32F, cv::Scalar(1.5)};
  cv::Mat color{kCamera.height, kCamera.width, CV_8UC3, cv::Scalar(0, 0, 0)};

  explicit LensImage(const Distortion& lens) {
    for (int v = 0; v < kCamera.height; ++v)
      for (int u = 0; u < kCamera.width; ++u) {
        Vector2d ray((u - kCamera.cx) / kCamera.fx, (v - kCamera.cy) / kCamera.fy);
        const Vector2d there = ray;
        for (int i = 0; i < 30; ++i) ray += there - lens.distorted(ray);  // Inverse by iteration.
        if (std::abs(ray.x()) < 0.2 && std::abs(ray.y()) < 0.2) depth.at<float>(v, u) = 1;
        if (ray.x() > 0.3) color.at<cv::Vec3b>(v, u) = {255, 255, 255};
      }
  }
};

TEST(Rectifier, StraightEdgesBecomeStraightAndDepthIsNeverMixed) {
  const Distortion lens = distortion_from("plumb_bob", {-0.3, 0.1, 0.001, -0.002, 0}, {});
  const LensImage image(lens);
  const Rectifier rectifier(kCamera, lens);
  const cv::Mat depth = rectifier.depth(image.depth), color = rectifier.color(image.color);
  int wrong = 0;
  for (int v = 2; v < kCamera.height - 2; ++v)
    for (int u = 2; u < kCamera.width - 2; ++u) {
      const float z = depth.at<float>(v, u);
      EXPECT_TRUE(std::isnan(z) || z == 1.0F || z == 1.5F) << z;
      const double x = (u - kCamera.cx) / kCamera.fx, y = (v - kCamera.cy) / kCamera.fy;
      const double to_edge = std::abs(std::max(std::abs(x), std::abs(y)) - 0.2) * kCamera.fx;
      if (to_edge > 1.5) wrong += z == (std::max(std::abs(x), std::abs(y)) < 0.2 ? 1.0F : 1.5F) ? 0 : 1;
      if (std::abs(x - 0.3) * kCamera.fx > 2)
        wrong += (color.at<cv::Vec3b>(v, u)[0] > 127) == (x > 0.3) ? 0 : 1;
    }
  EXPECT_EQ(wrong, 0);
}

TEST(GridHoles, AreClosedWithinSurfacesOnly) {
  cv::Mat depth(60, 80, CV_32F, cv::Scalar(0.8));
  depth(cv::Rect(40, 0, 40, 60)).setTo(1.4);
  EXPECT_FALSE(has_grid_holes(depth));
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 80; ++u)
      if (u % 2 == 0 || v % 2 == 0) depth.at<float>(v, u) = NAN;
  depth(cv::Rect(10, 10, 12, 12)).setTo(NAN);
  EXPECT_TRUE(has_grid_holes(depth));
  close_grid_holes(depth);
  EXPECT_FLOAT_EQ(depth.at<float>(30, 30), 0.8F);
  EXPECT_FLOAT_EQ(depth.at<float>(30, 60), 1.4F);
  EXPECT_TRUE(std::isnan(depth.at<float>(16, 16)));  // A real hole stays.
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 80; ++u) {
      const float z = depth.at<float>(v, u);
      EXPECT_TRUE(std::isnan(z) || z == 0.8F || z == 1.4F);
    }
}

TEST(GridHoles, OfARealShelfAreClosedAndThoseOfAKinectAreLeft) {
  const fs::path data = fs::path(LOCI_SHARED_DIR) / "data";
  if (!fs::exists(data / "shelf_bin")) GTEST_SKIP() << "no shared data";
  const auto shelf = open_recording(data / "shelf_bin");
  EXPECT_THAT(shelf->info().guesses, testing::Contains(testing::HasSubstr("the grid of holes is closed")));
  const cv::Mat raw = read_uint16(data / "shelf_bin/frame-000000.depth.png");
  const int before = cv::countNonZero(raw), after = cv::countNonZero(shelf->frame(0).depth > 0);
  EXPECT_GT(after, 1.5 * before);
  for (const char* name : {"redkitchen_rgbd", "osd_tabletop", "osd_changes"}) {
    if (!fs::exists(data / name)) continue;
    EXPECT_THAT(open_recording(data / name)->info().guesses,
                testing::Not(testing::Contains(testing::HasSubstr("grid of holes"))));
  }
}

TEST(RecordingYaml, DistortionIsReadAndUndone) {
  const fs::path folder = fs::path(testing::TempDir()) / "distorted_recording";
  fs::remove_all(folder);
  make_folder(folder);
  const Distortion lens = distortion_from("equidistant", {0.02, -0.01, 0, 0}, {});
  const LensImage image(lens);
  cv::Mat raw;
  image.depth.convertTo(raw, CV_16U, 1000);
  write_image(folder / "d.png", raw);
  write_image(folder / "c.png", image.color);
  write_file_atomically(folder / "frames.csv", "index,time_ns,color,depth\n0,1,c.png,d.png\n");
  const std::string camera = "{width: 320, height: 240, fx: 260, fy: 260, cx: 160, cy: 120";
  const std::string distortion = ", distortion: {model: equidistant, coefficients: [0.02, -0.01, 0, 0]}}\n";
  write_file_atomically(folder / "recording.yaml",
                        "cameras:\n  depth: " + camera + distortion + "  color: " + camera + distortion);
  const RgbdFrame frame = open_recording(folder)->frame(0);
  // The edge of the step, 0.2 to the right of the centre, and that of the colour, 0.3.
  EXPECT_FLOAT_EQ(frame.depth.at<float>(120, 160 + 50), 1);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(120, 160 + 54), 1.5);
  EXPECT_LT(frame.color.at<cv::Vec3b>(120, 160 + 76)[0], 50);
  EXPECT_GT(frame.color.at<cv::Vec3b>(120, 160 + 80)[0], 200);
  write_file_atomically(folder / "recording.yaml", "cameras:\n  depth: " + camera +
                                                       ", distortion: {model: spline, coefficients: [1]}}\n");
  EXPECT_THROW(open_recording(folder), Error);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace loci::mapping
