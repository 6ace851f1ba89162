#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "perception/annotators/segmentation/transparent_objects.h"

namespace loci::perception {
namespace {

/// A camera 1.2 m before a table that it looks at from 50° above.
struct Table {
  mapping::PinholeCamera camera;
  HoleSurface surface;
  cv::Mat depth;

  Table() : depth(480, 640, CV_32F) {
    surface.normal = Vector3d(0, -std::sin(0.87), -std::cos(0.87));
    surface.offset = surface.normal.dot(Vector3d(0, 0, 1.2));
    surface.inside = cv::Mat(480, 640, CV_8U, cv::Scalar(255));
    surface.taken = cv::Mat::zeros(480, 640, CV_8U);
    for (int v = 0; v < 480; ++v)
      for (int u = 0; u < 640; ++u)
        depth.at<float>(v, u) =
            static_cast<float>(surface.offset / surface.normal.dot(camera.unproject(u, v, 1)));
  }

  /// The outline of an upright cylinder that stands where the camera looks at.
  cv::Mat cylinder(double width, double height) const {
    std::vector<cv::Point> seen;
    const Vector3d x = Vector3d::UnitX();
    const Vector3d y = surface.normal.cross(x);
    for (const double up : {0.0, height})
      for (double angle = 0; angle < 6.28; angle += 0.1) {
        const Vector3d p = Vector3d(0, 0, 1.2) + up * surface.normal +
                           0.5 * width * (std::cos(angle) * x + std::sin(angle) * y);
        const Vector2d at = camera.project(p);
        seen.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
      }
    std::vector<cv::Point> hull;
    cv::convexHull(seen, hull);
    cv::Mat mask = cv::Mat::zeros(480, 640, CV_8U);
    cv::fillConvexPoly(mask, hull, cv::Scalar(255));
    return mask;
  }
  void pierce(const cv::Mat& mask) { depth.setTo(std::numeric_limits<float>::quiet_NaN(), mask); }
  std::vector<TransparentCandidate> find() const {
    return find_transparent(depth, camera, surface, TransparentOptions());
  }
};

TEST(TransparentCandidates, AHoleOfAGlassStandsWhereTheGlassDoes) {
  Table table;
  table.pierce(table.cylinder(0.07, 0.12));
  const auto found = table.find();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].width, 0.07, 0.01);
  EXPECT_NEAR(found[0].height, 0.12, 0.01);
  EXPECT_LT((found[0].foot - Vector3d(0, 0, 1.2)).norm(), 0.02);
  EXPECT_GT(found[0].surrounded, 0.95);
}

TEST(TransparentCandidates, AFewMeasurementsThroughTheGlassDoNotPartIt) {
  Table table;
  const cv::Mat whole = table.depth.clone();
  const cv::Mat mask = table.cylinder(0.07, 0.12);
  table.pierce(mask);
  for (int v = 0; v < 480; v += 7)
    for (int u = 0; u < 640; u += 9) table.depth.at<float>(v, u) = whole.at<float>(v, u);
  EXPECT_EQ(table.find().size(), 1U);
}

TEST(TransparentCandidates, TheShadowBesideAThingIsNone) {
  Table table;
  const cv::Mat mask = table.cylinder(0.10, 0.20);
  // The thing itself is measured, 10 cm before the table; what its projector does not reach lies left of it.
  const int width = static_cast<int>(585 * 0.075 * (1 / 0.9 - 1 / 1.2));
  cv::Mat shadow = cv::Mat::zeros(480, 640, CV_8U);
  mask(cv::Rect(width, 0, 640 - width, 480)).copyTo(shadow(cv::Rect(0, 0, 640 - width, 480)));
  table.pierce(shadow | mask);
  table.depth.setTo(0.9F, mask);
  EXPECT_TRUE(table.find().empty());
}

TEST(TransparentCandidates, HolesOfOtherSizesOrBesideTheSurfaceAreNone) {
  for (const auto& [width, height] : {std::pair(0.02, 0.12), {0.30, 0.12}, {0.07, 0.005}, {0.07, 0.45}}) {
    Table table;
    table.pierce(table.cylinder(width, height));
    EXPECT_TRUE(table.find().empty()) << width << " " << height;
  }
  Table table;
  table.pierce(table.cylinder(0.07, 0.12));
  table.surface.inside.setTo(0);
  EXPECT_TRUE(table.find().empty());
  EXPECT_TRUE(Table().find().empty());
}

}  // namespace
}  // namespace loci::perception
