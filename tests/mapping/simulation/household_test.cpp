#include "mapping/simulation/household.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

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

/// Objects whose lowest visible point is more than 4 cm above the table, of all that are seen well.
double share_off_the_table(Arrangement arrangement) {
  const HouseholdScenes tables(8, Random(3), arrangement);
  int seen = 0, above = 0;
  for (size_t i = 0; i < tables.size(); ++i) {
    const RgbdFrame frame = tables.frame(i);
    const PinholeCamera& camera = frame.camera.depth;
    std::map<uint16_t, std::vector<double>> heights;
    for (int v = 0; v < frame.depth.rows; ++v)
      for (int u = 0; u < frame.depth.cols; ++u)
        if (const uint16_t label = tables.labels().at<uint16_t>(v, u); label >= 20)
          if (const float z = frame.depth.at<float>(v, u); z > 0)
            heights[label].push_back((*frame.map_from_camera * Vector3d((u - camera.cx) / camera.fx * z,
                                                                        (v - camera.cy) / camera.fy * z, z))
                                         .z());
    for (auto& [label, all] : heights) {
      if (all.size() < 300) continue;
      std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 50));
      ++seen;
      above += static_cast<int>(all[all.size() / 50] > 0.04);
    }
  }
  return static_cast<double>(above) / seen;
}

TEST(Household, StacksAreObjectsUponEachOther) {
  EXPECT_GT(share_off_the_table(Arrangement::stacked), 0.3);
  EXPECT_LT(share_off_the_table(Arrangement::spread), 0.2);
}

}  // namespace
}  // namespace loci::mapping
