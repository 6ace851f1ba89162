#include "memory/belief/evidence/surface.h"

#include <gtest/gtest.h>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

class SurfaceOfABox : public ::testing::Test {
 protected:
  SurfaceOfABox() {
    kitchen.objects = {{"box", SyntheticKitchen::on_table(0, 0), {0.2, 0.15, 0.1}}};
    surface = sample_surfaces(kitchen.scene(0).view, 1, 200).at(0);
  }
  std::optional<double> displaced(double pose_error_m = 0) const {
    return displaced_share(observe_surface(kitchen.scene(60).view, surface, 0.7, pose_error_m));
  }

  SyntheticKitchen kitchen;
  Surface surface;
};

TEST_F(SurfaceOfABox, IsSampledAsOftenAsAsked) {
  EXPECT_GT(surface.size(), 100U);
  EXPECT_LE(surface.size(), 200U);
  for (const Eigen::Vector3f& point : surface) EXPECT_NEAR(point.x(), 0, 0.101);
}

TEST_F(SurfaceOfABox, StaysWhereNothingMoved) {
  EXPECT_EQ(displaced(), 0);
  EXPECT_GT(surface_log_ratio(0), 0.5);
}

TEST_F(SurfaceOfABox, IsSeenThroughWhereItMovedAway) {
  kitchen.objects[0].centre.x() += 0.02;
  const double little = displaced().value();
  EXPECT_GT(little, 0.03);
  kitchen.objects[0].centre.x() += 0.1;
  EXPECT_GT(displaced().value(), 2 * little);
  EXPECT_LT(surface_log_ratio(displaced().value()), surface_log_ratio(little));
  EXPECT_LT(surface_log_ratio(little), -0.5);
}

TEST_F(SurfaceOfABox, TellsNothingWhereItsSupportHasNearlyTheSameDepth) {
  kitchen.objects = {{"plate", SyntheticKitchen::on_table(0, 0, 0.004), {0.2, 0.2, 0.004}}};
  surface = sample_surfaces(kitchen.scene(0).view, 1, 200).at(0);
  EXPECT_GT(surface.size(), 100U);
  EXPECT_FALSE(displaced().has_value());
}

TEST_F(SurfaceOfABox, IsUnknownWhereLittleAroundItIsMeasured) {
  kitchen.objects[0].centre.x() += 1;
  SceneView view = kitchen.scene(60).view;
  EXPECT_GT(displaced_share(observe_surface(view, surface, 0.7, 0)).value(), 0.9);
  for (int v = 0; v < view.depth.rows; ++v)
    for (int u = 0; u < view.depth.cols; ++u)
      if (u % 4 != 0 || v % 2 != 0) view.depth.at<float>(v, u) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(displaced_share(observe_surface(view, surface, 0.7, 0)).has_value());
}

TEST_F(SurfaceOfABox, MayHaveMovedByTheErrorOfThePoses) {
  kitchen.objects[0].centre.x() += 0.03;
  EXPECT_GT(displaced(0).value(), 0.05);
  EXPECT_LT(displaced(0.02).value(), 0.02);
}

TEST_F(SurfaceOfABox, IsNotDisplacedWhereSomethingHidesIt) {
  kitchen.objects.push_back({"before", SyntheticKitchen::on_table(0.05, -0.2, 0.25), {0.1, 0.05, 0.25}});
  EXPECT_LT(displaced().value(), 0.02);
  kitchen.objects[1].size.x() = 1;
  EXPECT_FALSE(displaced().has_value()) << "nothing of it is in view";
}

}  // namespace
}  // namespace loci::memory::belief
