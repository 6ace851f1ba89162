#include "mapping/simulation/kitchen.h"

#include <gtest/gtest.h>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "mapping/world/contacts.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

class DrawnKitchens : public testing::TestWithParam<std::string_view> {};

TEST_P(DrawnKitchens, AreTheSameFromOneSeedAndOthersFromAnother) {
  const auto text = [](uint64_t seed) {
    const DrawnKitchen kitchen = draw_kitchen(GetParam(), seed);
    return urdf_text(kitchen.world) + to_json(kitchen.semantics).dump();
  };
  EXPECT_EQ(text(3), text(3));
  EXPECT_NE(text(3), text(4));
}

TEST_P(DrawnKitchens, AreUrdfWhoseFurnitureOpens) {
  for (uint64_t seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE(seed);
    const DrawnKitchen kitchen = draw_kitchen(GetParam(), seed);
    const World world = parse_urdf(urdf_text(kitchen.world), "kitchen.urdf");
    for (const Contact& contact : closed_contacts(world))
      ADD_FAILURE() << contact.first << " penetrates " << contact.second << " by " << contact.depth;
    for (const Joint& joint : world.joints) {
      if (joint.type != JointType::prismatic) continue;
      EXPECT_GT(free_range(world, joint).upper, 0.15) << joint.name;
    }
  }
}

TEST_P(DrawnKitchens, SayWhatTheyHold) {
  const DrawnKitchen kitchen = draw_kitchen(GetParam(), 1);
  std::map<std::string, size_t> counts;
  for (const auto& [name, link] : kitchen.semantics.links) {
    EXPECT_NE(kitchen.world.find_link(name), nullptr) << name;
    ++counts[link.class_name];
  }
  EXPECT_GE(counts["wall"], 4U);
  EXPECT_EQ(counts["floor"], 1U);
  EXPECT_GE(counts["drawer"] + counts["door"] + counts["flap"], 10U);
  EXPECT_GE(counts["handle"] + counts["knob"], 8U);
  EXPECT_GE(counts["counter"] + counts["table"] + counts["island"], 1U);
}

TEST_P(DrawnKitchens, HaveDrawersWithBottomsWithinTheirFronts) {
  const DrawnKitchen kitchen = draw_kitchen(GetParam(), 1);
  size_t drawers = 0;
  for (const auto& [name, link] : kitchen.semantics.links) {
    if (link.class_name != "drawer") continue;
    ++drawers;
    const SemanticLink& bottom = kitchen.semantics.links.at(name + "_bottom");
    EXPECT_EQ(bottom.class_name, "drawer_bottom");
    EXPECT_EQ(kitchen.world.parent_joint(name + "_bottom")->parent, name);
    const double middle = link.geometry.at("centre").at(2).get<double>(),
                 half = link.geometry.at("height").get<double>() / 2,
                 height = bottom.geometry.at("height").get<double>();
    EXPECT_GT(height, middle - half) << name;
    EXPECT_LT(height, middle) << name;
  }
  EXPECT_GE(drawers, 1U);
}

INSTANTIATE_TEST_SUITE_P(Layouts, DrawnKitchens, testing::ValuesIn(kKitchenLayouts),
                         [](const auto& layout) { return std::string(layout.param); });

TEST(DrawnKitchen, AnUnknownLayoutIsRefusedWithTheKnownOnes) {
  try {
    draw_kitchen("castle", 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("peninsula"), std::string::npos);
  }
}

}  // namespace
}  // namespace loci::mapping
