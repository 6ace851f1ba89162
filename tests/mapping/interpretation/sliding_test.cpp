#include "mapping/interpretation/furniture/sliding.h"

#include <gtest/gtest.h>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/world/world.h"

namespace loci::mapping::test {
namespace {

/// An upright panel with a bar at a place across it; looks along x from `out`.
Front a_panel(const std::string& name, double left, double right, double out, double bar) {
  Front front;
  front.name = name;
  front.centre = {out, (left + right) / 2, 0.6};
  front.width = right - left;
  front.height = 1;
  front.confidence = 0.9;
  front.fixture = Fixture{};
  front.fixture->length = 0.2;
  front.fixture->centre = {out + 0.03, bar, 0.6};
  front.joint = joint_prior(front);
  front.class_name = front_class(front, *front.joint);
  return front;
}

TEST(SlidingPanels, OneThatStandsBeforeItsNeighbourSlidesPastIt) {
  std::vector<Front> fronts = {a_panel("door_1", 0, 0.6, -0.03, 0.06), a_panel("door_2", 0.6, 1.25, 0, 1.19)};
  ASSERT_EQ(fronts[0].joint->type, ArticulationType::revolute);
  ASSERT_GT(fronts[0].joint->probabilities[2], 0.9);
  pair_sliding_panels(fronts);
  for (const Front& front : fronts) {
    EXPECT_TRUE(slides_sideways(front));
    EXPECT_EQ(front.class_name, "door");
    EXPECT_NEAR(front.joint->probabilities[1], 0.7, 0.05);
    EXPECT_NEAR(front.joint->upper, 0.6, 1e-9);
  }
  EXPECT_GT(fronts[0].joint->axis.y(), 0.99);
  EXPECT_LT(fronts[1].joint->axis.y(), -0.99);

  World world;
  world.name = world.root = "map";
  world.links.resize(1);
  world.links[0].name = "map";
  SemanticMap semantics;
  add_fronts(fronts, "map", world, semantics);
  const Joint* joint = world.find_joint("door_1_joint");
  ASSERT_NE(joint, nullptr);
  EXPECT_EQ(joint->type, JointType::prismatic);
  const std::vector<Front> read = fronts_of(world, semantics);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_TRUE(slides_sideways(read[0]));
  for (const auto& [name, link] : semantics.links) EXPECT_NE(link.class_name, "drawer_side") << name;
}

TEST(SlidingPanels, FrontsOfOnePlaneAndThoseOfOtherHeightsAreHinged) {
  std::vector<Front> flush = {a_panel("door_1", 0, 0.6, 0, 0.06), a_panel("door_2", 0.6, 1.2, 0, 1.14)};
  pair_sliding_panels(flush);
  std::vector<Front> lower = {a_panel("door_1", 0, 0.6, -0.03, 0.06), a_panel("door_2", 0.6, 1.2, 0, 1.14)};
  lower[0].height = 0.8;
  pair_sliding_panels(lower);
  for (const auto* fronts : {&flush, &lower})
    for (const Front& front : *fronts) EXPECT_EQ(front.joint->type, ArticulationType::revolute);
}

}  // namespace
}  // namespace loci::mapping::test
