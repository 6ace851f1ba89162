#include "mapping/interpretation/furniture/prior_joints.h"

#include <gtest/gtest.h>

#include <numeric>

#include "mapping/articulation/articulation.h"

namespace loci::mapping {
namespace {

/// Looks along x; u (to its right) is y.
Front a_bare_front(double u0, double u1, double v0, double v1) {
  Front front;
  front.centre = {0, (u0 + u1) / 2, (v0 + v1) / 2};
  front.width = u1 - u0;
  front.height = v1 - v0;
  front.confidence = 0.9;
  set_prior_joint(front);
  return front;
}

Front a_bare_door(double u0, double u1) {
  return a_bare_front(u0, u1, 0.1, 0.85);
}

/// An upright bar at its left edge, unless it is level above its middle.
Front a_front_with_bar(double u0, double u1, double v0, double v1, bool level = false) {
  Front front = a_bare_front(u0, u1, v0, v1);
  front.fixture = Fixture{};
  front.fixture->axis = level ? Vector3d::UnitY() : Vector3d::UnitZ();
  front.fixture->length = 0.15;
  front.fixture->centre = {0.03, level ? (u0 + u1) / 2 : u0 + 0.05, v1 - 0.1};
  set_prior_joint(front);
  return front;
}

double probability_of(const Front& front, ArticulationType type) {
  return front.joint->probabilities[static_cast<size_t>(type)];
}

TEST(PriorJoints, DoorsWithoutHandleOpenAwayFromTheOtherOneOfAPair) {
  // A pair, a door with a handle, and one without for which nothing shows the side.
  std::vector<Front> fronts = {a_bare_door(0.4, 0.8), a_bare_door(0, 0.4),
                               a_front_with_bar(0.8, 1.2, 0.1, 0.85), a_bare_door(1.25, 1.67)};
  ASSERT_EQ(fronts[0].class_name, "door");
  follow_neighbours(fronts);
  EXPECT_EQ(fronts[0].joint->hinge_from, "pair");
  EXPECT_GT(fronts[0].joint->axis.z(), 0);
  EXPECT_NEAR(fronts[0].joint->origin.y(), 0.8, 1e-9);
  EXPECT_EQ(fronts[1].joint->hinge_from, "pair");
  EXPECT_LT(fronts[1].joint->axis.z(), 0);
  EXPECT_NEAR(fronts[1].joint->origin.y(), 0, 1e-9);
  EXPECT_EQ(fronts[2].joint->hinge_from, "");
  EXPECT_EQ(fronts[3].joint->hinge_from, "assumed");
}

TEST(PriorJoints, OfThreeEqualDoorsWithoutHandleItIsOpenWhichAreAPair) {
  std::vector<Front> fronts = {a_bare_door(0, 0.4), a_bare_door(0.4, 0.8), a_bare_door(0.8, 1.2)};
  follow_neighbours(fronts);
  for (const Front& front : fronts) EXPECT_EQ(front.joint->hinge_from, "assumed");
}

TEST(PriorJoints, APairBelowADrawerAreDoorsThoughEitherAloneMightBeADrawer) {
  std::vector<Front> fronts = {a_bare_front(0, 0.38, 0.1, 0.68), a_bare_front(0.385, 0.775, 0.1, 0.68),
                               a_front_with_bar(0, 0.775, 0.685, 0.87, true)};
  for (size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(fronts[i].joint) << "a front opens";
    EXPECT_LT(probability_of(fronts[i], fronts[i].joint->type), 0.5) << "but how is open";
  }
  follow_neighbours(fronts);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(fronts[i].class_name, "door");
    EXPECT_EQ(fronts[i].joint->hinge_from, "pair");
    EXPECT_LT(probability_of(fronts[i], ArticulationType::revolute), 0.8);
    const auto& all = fronts[i].joint->probabilities;
    EXPECT_NEAR(std::accumulate(all.begin(), all.end(), 0.0), 1, 1e-9);
  }
  EXPECT_LT(fronts[0].joint->axis.z(), 0);
  EXPECT_GT(fronts[1].joint->axis.z(), 0);
}

TEST(PriorJoints, AFrontWithoutHandleOpensAsTheEqualOneBesideItThatHasOne) {
  std::vector<Front> fronts = {a_front_with_bar(0, 0.47, 0.1, 0.62), a_bare_front(0.47, 0.94, 0.1, 0.62)};
  ASSERT_EQ(fronts[0].class_name, "door");
  ASSERT_EQ(fronts[1].class_name, "drawer");
  follow_neighbours(fronts);
  EXPECT_EQ(fronts[1].class_name, "door");
}

TEST(PriorJoints, AToeKickAndAFillerStripStayFixed) {
  for (const Front& front : {a_bare_front(0, 1.8, 0, 0.14), a_bare_front(0, 0.6, 0.01, 0.15),
                             a_bare_front(0, 0.12, 0.1, 0.86), a_bare_front(0, 0.15, 0.1, 0.62)}) {
    EXPECT_FALSE(front.joint) << front.width << " x " << front.height;
    EXPECT_EQ(front.class_name, "front");
  }
  EXPECT_EQ(a_bare_front(0, 0.6, 0.1, 0.25).class_name, "drawer") << "over a plinth";
}

}  // namespace
}  // namespace loci::mapping
