#include "mapping/simulation/household.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/simulation/household_scenes.h"

namespace loci::mapping {
namespace {

TEST(Household, EveryClassGivesObjectsOfASizeToHandleThatStandOnZero) {
  ASSERT_EQ(household_classes().size(), 30U);
  EXPECT_TRUE(std::ranges::is_sorted(household_classes()));
  for (const std::string& name : household_classes()) {
    Random draw(7);
    for (int i = 0; i < 5; ++i) {
      const HouseholdObject object = draw_household_object(name, draw);
      Eigen::AlignedBox3f bounds;
      for (const auto& vertex : object.mesh.vertices) bounds.extend(vertex);
      EXPECT_NEAR(bounds.min().z(), 0, 1e-5) << name;
      EXPECT_NEAR(bounds.max().z(), object.top, 1e-5) << name;
      EXPECT_GT(bounds.sizes().maxCoeff(), 0.04F) << name;
      EXPECT_LT(bounds.sizes().maxCoeff(), 0.5F) << name;
      EXPECT_EQ(object.mesh.colors.size(), object.mesh.triangles.size()) << name;
      EXPECT_LE(object.room, object.reach + 1e-6) << name;
    }
  }
}

TEST(Household, TheSameSeedGivesTheSameTableAndLabelsNameEveryObject) {
  const HouseholdScenes tables(3, Random(5)), again(3, Random(5));
  const RgbdFrame frame = tables.frame(1);
  const RgbdFrame other = again.frame(1);
  EXPECT_EQ(cv::norm(frame.color, other.color, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(tables.labels() != again.labels()), 0);
  double most = 0;
  cv::minMaxLoc(tables.labels(), nullptr, &most);
  ASSERT_GE(most, 20);
  EXPECT_FALSE(tables.class_of(static_cast<int>(most)).empty());
  EXPECT_TRUE(frame.map_from_camera.has_value());
}

}  // namespace
}  // namespace loci::mapping
