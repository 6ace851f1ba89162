#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/random.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"
#include "perception/annotators/segmentation/flat_objects.h"
#include "perception/annotators/segmentation/flat_surface.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
namespace {

/// A camera before a plane that it looks at from 50° above; the surface waves by millimetres and bears
/// one flat piece of another hue.
struct Workspace {
  mapping::RgbdCamera camera;
  FlatSurface surface;
  double height = 0.010;  ///< of the piece
  Vector2d low{-0.06, -0.03};
  Vector2d high{0.06, 0.03};

  double distance;  ///< of the surface, in the middle of the image

  explicit Workspace(double away = 1.2) : distance(away) {
    surface.normal = Vector3d(0, -std::sin(0.87), -std::cos(0.87));
    surface.offset = surface.normal.dot(Vector3d(0, 0, distance));
    surface.inside = cv::Mat(camera.depth.height, camera.depth.width, CV_8U, cv::Scalar(255));
  }

  Vector2d on_plane(const Vector3d& p) const {
    const Vector3d x = Vector3d::UnitX();
    return {x.dot(p), surface.normal.cross(x).dot(p - Vector3d(0, 0, distance))};
  }
  bool on_piece(const Vector2d& at) const {
    return (at.array() > low.array()).all() && (at.array() < high.array()).all();
  }
  Vector3d meet(int u, int v) const {
    const Vector3d ray = camera.depth.unproject(u, v, 1);
    return surface.offset / surface.normal.dot(ray) * ray;
  }

  cv::Mat depth(bool with_piece, Random random) const {
    cv::Mat result(camera.depth.height, camera.depth.width, CV_32F);
    for (int v = 0; v < result.rows; ++v)
      for (int u = 0; u < result.cols; ++u) {
        const Vector3d p = meet(u, v);
        const Vector2d at = on_plane(p);
        const double wave = 0.004 * std::sin(9 * at.x()) * std::cos(7 * at.y());
        const double up = wave + (with_piece && on_piece(at) ? height : 0);
        const double z = p.z() + up / surface.normal.dot(p / p.z());
        const double disparity = 0.075 * 585 / z + random.normal(0.1);
        result.at<float>(v, u) = static_cast<float>(0.075 * 585 / (std::round(8 * disparity) / 8));
      }
    return result;
  }

  /// Light falls off to one side by as much as `dim`.
  cv::Mat color(double dim, Random random) const {
    cv::Mat result(camera.color.height, camera.color.width, CV_8UC3);
    for (int v = 0; v < result.rows; ++v)
      for (int u = 0; u < result.cols; ++u) {
        const double light = 1 - dim * u / result.cols;
        const Vector3d base =
            on_piece(on_plane(meet(u, v))) ? Vector3d(90, 140, 190) : Vector3d(130, 150, 120);
        for (int c = 0; c < 3; ++c)
          result.at<cv::Vec3b>(v, u)[c] = static_cast<unsigned char>(light * base[c] + random.normal(2));
      }
    return result;
  }

  double overlap(const FlatObject& object) const {
    int both = 0;
    int own = 0;
    int piece = 0;
    for (int v = 0; v < camera.color.height; ++v)
      for (int u = 0; u < camera.color.width; ++u) {
        const bool found = object.box.contains({u, v}) &&
                           object.mask.at<unsigned char>(v - object.box.y, u - object.box.x) != 0;
        const bool there = on_piece(on_plane(meet(u, v)));
        both += found && there ? 1 : 0;
        own += found ? 1 : 0;
        piece += there ? 1 : 0;
      }
    return static_cast<double>(both) / (own + piece - both);
  }
};

TEST(FlatObjects, APieceOfTenMillimetresIsFoundOnAnUnevenTableUnderAnyLight) {
  Workspace workspace;
  SurfaceCalibration calibration;
  for (uint64_t i = 0; i < 15; ++i) calibration.add(workspace.depth(false, Random(100 + i)));
  for (const bool calibrated : {true, false})
    for (const double dim : {0.0, 0.7}) {
      FlatSurface surface = workspace.surface;
      if (calibrated) surface.empty_depth = calibration.mean();
      const std::vector<FlatObject> found =
          find_flat_objects(workspace.depth(true, Random(1)), workspace.color(dim, Random(2)),
                            workspace.camera, surface, FlatOptions());
      ASSERT_EQ(found.size(), 1U) << calibrated << dim;
      EXPECT_GT(workspace.overlap(found[0]), 0.85) << calibrated << dim;
      EXPECT_NEAR(found[0].height, 0.010, 0.002);
    }
}

TEST(FlatObjects, NoiseOfAFarSurfaceIsNone) {
  for (const double distance : {2.4, 2.8, 3.2, 3.6}) {
    const Workspace workspace(distance);
    const std::vector<FlatObject> found =
        find_flat_objects(workspace.depth(false, Random(1)), workspace.color(0.3, Random(2)),
                          workspace.camera, workspace.surface, FlatOptions());
    EXPECT_TRUE(found.empty()) << distance;
  }
}

/// The correlation window of a sensor gives neighbouring pixels one error: patches of centimetres rise by as
/// much as an object does, though not in another colour.
TEST(FlatObjects, PatchesOfNoiseInTheColourOfTheTableAreNone) {
  const Workspace workspace(1.6);
  Random random(1);
  cv::Mat noise(workspace.camera.depth.height, workspace.camera.depth.width, CV_32F);
  for (float& value : cv::Mat_<float>(noise)) value = static_cast<float>(random.normal(0.63));
  cv::blur(noise, noise, {9, 9});
  cv::Mat depth = workspace.depth(false, Random(2));
  constexpr float kFocalTimesBaseline = 0.075f * 585;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      depth.at<float>(v, u) =
          kFocalTimesBaseline / (kFocalTimesBaseline / depth.at<float>(v, u) + noise.at<float>(v, u));
  const cv::Mat color = workspace.color(0.3, Random(3));
  FlatOptions options;
  EXPECT_TRUE(find_flat_objects(depth, color, workspace.camera, workspace.surface, options).empty());
  options.min_contrast = 0;
  EXPECT_FALSE(find_flat_objects(depth, color, workspace.camera, workspace.surface, options).empty());
}

TEST(ColorContrast, CountsInStandardDeviations) {
  Random random(1);
  cv::Mat color(60, 60, CV_8UC3);
  const cv::Rect box(20, 20, 20, 20);
  for (int v = 0; v < color.rows; ++v)
    for (int u = 0; u < color.cols; ++u)
      for (int c = 0; c < 3; ++c)
        color.at<cv::Vec3b>(v, u)[c] =
            cv::saturate_cast<uchar>((box.contains({u, v}) ? 140 : 100) + random.normal(10));
  const cv::Mat mask(box.size(), CV_8U, cv::Scalar(255)), ground(color.size(), CV_8U, cv::Scalar(255));
  const double contrast = color_contrast(color, box, mask, ground);
  EXPECT_GT(contrast, 3);
  EXPECT_LT(contrast, 10);
  EXPECT_LT(color_contrast(color, {2, 2, 14, 14}, cv::Mat(14, 14, CV_8U, cv::Scalar(255)), ground), 0.5);
  EXPECT_EQ(color_contrast(color, box, mask, cv::Mat::zeros(color.size(), CV_8U)), 0);
}

TEST(FlatObjects, AnEmptyTableHasNoneWhateverItsColours) {
  Workspace workspace;
  const std::vector<FlatObject> found =
      find_flat_objects(workspace.depth(false, Random(1)), workspace.color(0.3, Random(2)), workspace.camera,
                        workspace.surface, FlatOptions());
  EXPECT_TRUE(found.empty());
}

TEST(FlatObjects, AThinThingIsFoundByTheStepAlongItsBorder) {
  Workspace workspace;
  workspace.height = 0.005;
  const std::vector<FlatObject> found =
      find_flat_objects(workspace.depth(true, Random(1)), workspace.color(0.3, Random(2)), workspace.camera,
                        workspace.surface, FlatOptions());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(workspace.overlap(found[0]), 0.7);
}

TEST(FlatObjects, WhatIsOnlyPaintedOnTheTableIsNone) {
  Workspace workspace;
  workspace.height = 0;
  for (uint64_t seed = 1; seed < 4; ++seed)
    EXPECT_TRUE(find_flat_objects(workspace.depth(true, Random(seed)),
                                  workspace.color(0.3, Random(10 + seed)), workspace.camera,
                                  workspace.surface, FlatOptions())
                    .empty());
}

TEST(FlatObjects, WithoutThinThingsOnlyTheCertainOnesAreFound) {
  Workspace workspace;
  workspace.height = 0.005;
  FlatOptions options;
  options.thin_m = 0;
  EXPECT_TRUE(find_flat_objects(workspace.depth(true, Random(1)), workspace.color(0.3, Random(2)),
                                workspace.camera, workspace.surface, options)
                  .empty());
}

/// A piece of 40 × 40 pixels, `rise` higher than what is left of it and below, `right` higher than what is
/// right of it and above, on a surface that slopes.
bool rises(float rise, float right, double step) {
  cv::Mat heights(120, 120, CV_32F);
  std::vector<int> pixels;
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 120; ++u) {
      const bool own = u >= 40 && u < 80 && v >= 40 && v < 80;
      heights.at<float>(v, u) = 1e-4f * static_cast<float>(u) + (own                 ? rise
                                                                 : u >= 80 || v < 40 ? rise - right
                                                                                     : 0);
      if (own) pixels.push_back(v * 120 + u);
    }
  return rises_all_around(heights, pixels, cv::Mat(120, 120, CV_8U, cv::Scalar(255)), step);
}

TEST(ThinObjects, RiseAlongTheirWholeBorderOnASlopingSurface) {
  EXPECT_TRUE(rises(0.005f, 0.005f, 0.003));
  EXPECT_FALSE(rises(0.002f, 0.002f, 0.003));
  EXPECT_FALSE(rises(0.005f, 0.0f, 0.003));  // The corner of a board.
  EXPECT_FALSE(rises_all_around(cv::Mat::zeros(10, 10, CV_32F), {}, cv::Mat::zeros(10, 10, CV_8U), 0.003));
}

TEST(ThinObjects, TheSurfaceBendsAsAWholeAndNotForAThing) {
  const mapping::PinholeCamera camera;
  const Vector3d normal = -Vector3d::UnitZ();
  cv::Mat heights(camera.height, camera.width, CV_32F);
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const double x = (u - camera.cx) / camera.fx;
      const bool thing = u >= 200 && u < 400 && v >= 150 && v < 300;
      heights.at<float>(v, u) = static_cast<float>(0.004 - 0.01 * x * x + (thing ? 0.005 : 0));
    }
  const cv::Mat leveled = over_bent_surface(heights, camera, normal, -1.0);
  EXPECT_NEAR(leveled.at<float>(50, 50), 0, 0.001);
  EXPECT_NEAR(leveled.at<float>(400, 320), 0, 0.001);
  EXPECT_NEAR(leveled.at<float>(220, 300), 0.005, 0.001);
}

TEST(FlatObjects, WhatStandsHigherIsNotFlat) {
  Workspace workspace;
  workspace.height = 0.045;
  const std::vector<FlatObject> found =
      find_flat_objects(workspace.depth(true, Random(1)), workspace.color(0, Random(2)), workspace.camera,
                        workspace.surface, FlatOptions());
  for (const FlatObject& object : found) EXPECT_LT(workspace.overlap(object), 0.2);
}

TEST(FlatObjects, TheInsideOfAPlateBelongsToItsRim) {
  Workspace workspace;
  const cv::Mat depth = workspace.depth(false, Random(1));
  cv::Mat color(workspace.camera.color.height, workspace.camera.color.width, CV_8UC3,
                cv::Scalar(40, 90, 160));
  const auto ring = [&](int from, int to, bool whole) {
    std::vector<int> pixels;
    for (int v = -to; v <= to; ++v)
      for (int u = -to; u <= to; ++u)
        if (u * u + v * v >= from * from && u * u + v * v < to * to && (whole || v > 3 * to / 4))
          pixels.push_back((240 + v) * depth.cols + 320 + u);
    return pixels;
  };
  const FlatObject inside{{}, {}, ring(0, 30, true), 0.008};
  const auto in_rim = [&](bool whole) {
    return is_part_of_cluster(inside, {ring(36, 44, whole)}, depth, color, workspace.camera);
  };
  EXPECT_TRUE(in_rim(true));
  EXPECT_FALSE(in_rim(false)) << "it touches the rest of an object along a small part of its outline";
  EXPECT_FALSE(is_part_of_cluster(inside, {}, depth, color, workspace.camera));
  cv::circle(color, {320, 240}, 32, cv::Scalar(160, 90, 40), cv::FILLED);
  EXPECT_FALSE(in_rim(true)) << "it has another colour";
}

TEST(FlatObjects, AreNotLookedForWhereTheMapHidesTheSupport) {
  const mapping::PinholeCamera camera{8, 1, 50, 50, 1.5, 0};
  const Vector3d up(0, 0, -1);  // the camera looks straight down on a surface 1 m below: a pixel shows 2 cm
  cv::Mat inside(1, 8, CV_8U, cv::Scalar(255));
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat map_depth = (cv::Mat_<float>(1, 8) << 1.0F, 1.0F, 0.95F, 1.0F, nothing, 1.0F, 1.0F, 0.994F);
  const cv::Mat bare = (cv::Mat_<unsigned char>(1, 8) << 255, 255, 255, 255, 255, 255, 255, 0);
  leave_out_what_the_map_shows(map_depth, bare, up, -1.0, camera, inside);
  // A board over the surface, and a hob in it, with what is beside them.
  const cv::Mat left = (cv::Mat_<unsigned char>(1, 8) << 255, 0, 0, 0, 255, 255, 0, 0);
  EXPECT_EQ(cv::countNonZero(inside != left), 0) << inside;
}

TEST(SurfaceCalibration, IsTheMeanAndKnowsWhatItNeverSaw) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  SurfaceCalibration calibration;
  calibration.add((cv::Mat_<float>(1, 3) << 1.0f, nan, 2.0f));
  calibration.add((cv::Mat_<float>(1, 3) << 1.002f, nan, nan));
  calibration.add((cv::Mat_<float>(1, 3) << 0.998f, 1.0f, nan));
  const cv::Mat mean = calibration.mean();
  EXPECT_NEAR(mean.at<float>(0, 0), 1.0f, 1e-5f);
  EXPECT_TRUE(std::isnan(mean.at<float>(0, 1)));
  EXPECT_TRUE(std::isnan(mean.at<float>(0, 2)));
  EXPECT_THROW(calibration.add(cv::Mat_<float>(2, 2)), Error);
}

TEST(SurfaceCalibration, SurvivesItsFile) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "surface.png";
  const cv::Mat depth = (cv::Mat_<float>(1, 3) << 1.2345f, std::numeric_limits<float>::quiet_NaN(), 0.6f);
  write_surface(path, depth);
  const cv::Mat again = read_surface(path);
  EXPECT_NEAR(again.at<float>(0, 0), 1.2345f, 1e-4f);
  EXPECT_TRUE(std::isnan(again.at<float>(0, 1)));
  EXPECT_NEAR(again.at<float>(0, 2), 0.6f, 1e-4f);
}

}  // namespace
}  // namespace loci::perception
