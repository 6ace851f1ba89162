#include "memory/belief/evidence/visibility.h"

#include <gtest/gtest.h>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

const AxisBox kCup{SyntheticKitchen::on_table(0, 0), Vector3d(0.08, 0.08, 0.1)};

double sum(const Visibility& v) {
  return v.out_of_view + v.hidden + v.unmeasured + v.occupied + v.seen_through;
}

TEST(Visibility, PresentObjectOccupiesItsSpot) {
  SyntheticKitchen kitchen;
  kitchen.objects = {{"cup", kCup.centre, kCup.size, {}}};
  const Visibility v = visibility_of(kitchen.scene(0).view, kCup, 0.005);
  EXPECT_GT(v.occupied, 0.95);
  EXPECT_NEAR(sum(v), 1, 1e-9);
  EXPECT_LT(undetectable(v, 1), 0.05);
}

TEST(Visibility, EmptyTableIsSeenThrough) {
  const Visibility v = visibility_of(SyntheticKitchen().scene(0).view, kCup, 0.005);
  EXPECT_GT(v.seen_through, 0.9);
  EXPECT_GT(v.empty_share(), 0.9);
}

TEST(Visibility, ObjectInFrontHides) {
  SyntheticKitchen kitchen;
  kitchen.objects = {{"board", SyntheticKitchen::on_table(0, -0.25, 0.3), Vector3d(0.4, 0.02, 0.3), {}}};
  const Visibility v = visibility_of(kitchen.scene(0).view, kCup, 0.005);
  EXPECT_GT(v.hidden, 0.95);
  EXPECT_GT(undetectable(v, 1), 0.95);
}

TEST(Visibility, BesideTheImageIsOutOfView) {
  SyntheticKitchen kitchen;
  const AxisBox far_left{SyntheticKitchen::on_table(-2, 0), kCup.size};
  EXPECT_DOUBLE_EQ(visibility_of(kitchen.scene(0).view, far_left, 0.005).out_of_view, 1);
  const AxisBox behind{Vector3d(0, -3, 1), kCup.size};
  EXPECT_DOUBLE_EQ(visibility_of(kitchen.scene(0).view, behind, 0.005).out_of_view, 1);
}

TEST(Visibility, HalfAcrossTheBorderIsHalfOutOfView) {
  SyntheticKitchen kitchen;
  const double z = (kitchen.map_from_camera.inverse() * kCup.centre).z();
  const double border =
      (-0.5 - kitchen.camera.cx) / kitchen.camera.fx * z;  // x of the left image border there
  const AxisBox box{kCup.centre + Vector3d(border, 0, 0), kCup.size};
  const Visibility v = visibility_of(kitchen.scene(0).view, box, 0.0);
  EXPECT_NEAR(v.out_of_view, 0.5, 0.15);
}

TEST(Visibility, UncertainPositionBlursTheBorder) {
  SyntheticKitchen kitchen;
  const double z = (kitchen.map_from_camera.inverse() * kCup.centre).z();
  const double border = (-0.5 - kitchen.camera.cx) / kitchen.camera.fx * z;
  const AxisBox box{kCup.centre + Vector3d(border - 0.06, 0, 0), kCup.size};
  EXPECT_DOUBLE_EQ(visibility_of(kitchen.scene(0).view, box, 0.0).out_of_view, 1);
  EXPECT_LT(visibility_of(kitchen.scene(0).view, box, 0.1).out_of_view, 0.9);
}

TEST(Visibility, NoMeasurementIsNoEvidence) {
  Scene scene = SyntheticKitchen().scene(0);
  scene.view.depth.setTo(std::numeric_limits<float>::quiet_NaN());
  const Visibility v = visibility_of(scene.view, kCup, 0.005);
  EXPECT_DOUBLE_EQ(v.unmeasured, 1);
  EXPECT_DOUBLE_EQ(v.empty_share(), 0);
  EXPECT_DOUBLE_EQ(undetectable(v, 1), 1);
}

TEST(Visibility, MapHidesEvenWhereTheSensorMeasuresNothing) {
  Scene scene = SyntheticKitchen().scene(0);
  scene.view.depth.setTo(std::numeric_limits<float>::quiet_NaN());
  scene.view.map_depth = cv::Mat(scene.view.depth.size(), CV_32F, cv::Scalar(0.6));  // a cupboard's front
  EXPECT_DOUBLE_EQ(visibility_of(scene.view, kCup, 0.005).hidden, 1);
}

TEST(Visibility, AttributesSurfacesToObservations) {
  SyntheticKitchen kitchen;
  kitchen.objects = {{"a", SyntheticKitchen::on_table(0.3, 0), Vector3d(0.1, 0.1, 0.1), {}},
                     {"b", kCup.centre, kCup.size, {}}};
  const Scene scene = kitchen.scene(0);
  const BoxVisibility seen = box_visibility(scene.view, kCup, 0.0, scene.observations.size());
  ASSERT_EQ(seen.occupied_by.size(), 2U);
  EXPECT_DOUBLE_EQ(seen.occupied_by[0], 0);
  EXPECT_GT(seen.occupied_by[1], 0.9);
}

TEST(Visibility, ObservedFractionOfATableHalfInView) {
  SyntheticKitchen kitchen;
  const Scene scene = kitchen.scene(0);
  const std::vector<Vector3d> inside = {
      {-0.2, -0.2, 0.7}, {0.2, -0.2, 0.7}, {0.2, 0.2, 0.7}, {-0.2, 0.2, 0.7}};
  EXPECT_GT(observed_fraction(scene.view, inside), 0.99);
  const std::vector<Vector3d> beside = {{-9, -0.2, 0.7}, {-8, -0.2, 0.7}, {-8, 0.2, 0.7}, {-9, 0.2, 0.7}};
  EXPECT_DOUBLE_EQ(observed_fraction(scene.view, beside), 0);
  const std::vector<Vector3d> long_table = {{0, -0.1, 0.7}, {5, -0.1, 0.7}, {5, 0.1, 0.7}, {0, 0.1, 0.7}};
  const double half = observed_fraction(scene.view, long_table);
  EXPECT_GT(half, 0.05);
  EXPECT_LT(half, 0.4);
}

TEST(Resolved, FallsWithTheDistanceAndNotWithTheSizeOfAStoredImage) {
  SceneView view;
  view.camera = {640, 480, 585, 585, 320, 240};
  const AxisBox cup{Vector3d(0, 3, 0.75), Vector3d(0.08, 0.08, 0.1)};
  const auto from = [](double distance) {
    return SyntheticKitchen::look_from({0, 3 - distance, 1.4}, {0, 3, 0.75});
  };
  EXPECT_GT(resolved(view, from(1), cup), 0.99);
  EXPECT_GT(resolved(view, from(2), cup), 0.8);
  EXPECT_LT(resolved(view, from(4), cup), 0.2);
  SceneView thumbnail = view;
  thumbnail.camera = {160, 120, 146.25, 146.25, 80, 60};
  thumbnail.sensor_pixels = 16;
  EXPECT_NEAR(resolved(thumbnail, from(2.5), cup), resolved(view, from(2.5), cup), 1e-9);
}

}  // namespace
}  // namespace loci::memory::belief
