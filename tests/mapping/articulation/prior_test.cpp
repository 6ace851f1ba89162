#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "mapping/articulation/articulation.h"
#include "mapping/base/text/json.h"

namespace loci::mapping {
namespace {

/// A front that faces south (-y), with a horizontal bar at `side` and `rise` (metres from the centre).
Front front_with_bar(double width, double height, double z, double side, double rise, bool upright = false) {
  Front front;
  front.centre = {1, 2, z};
  front.normal = -Vector3d::UnitY();
  front.width = width;
  front.height = height;
  front.depth = 0.5;
  front.fixture = Fixture{};
  front.fixture->axis = upright ? front.up : front.right();
  front.fixture->length = 0.16;
  front.fixture->centre = front.centre + side * front.right() + rise * front.up + 0.03 * front.normal;
  return front;
}

Front front_with_knob(double width, double height, double z, double side, double rise) {
  Front front = front_with_bar(width, height, z, side, rise);
  front.fixture->kind = Fixture::Kind::knob;
  front.fixture->axis = front.normal;
  front.fixture->length = 0.03;
  return front;
}

double probability(const JointEstimate& joint, ArticulationType type) {
  return joint.probabilities[static_cast<size_t>(type)];
}

/// How the edge opposite to the hinge starts to move when the joint opens.
Vector3d opening_direction(const Front& front, const JointEstimate& joint) {
  const Vector3d free_edge = 2 * (front.centre - joint.origin);
  return joint.axis.cross(free_edge).normalized();
}

TEST(JointPrior, BarAlongAWideLowFrontIsADrawerThatOpensOutwards) {
  for (const double rise : {0.0, 0.07}) {
    const Front front = front_with_bar(0.6, 0.2, 0.7, 0, rise);
    const JointEstimate joint = joint_prior(front);
    EXPECT_EQ(joint.type, ArticulationType::prismatic);
    EXPECT_GT(probability(joint, ArticulationType::prismatic), 0.9);
    EXPECT_NEAR(joint.axis.dot(front.normal), 1, 1e-12);
    EXPECT_NEAR(joint.upper, 0.45, 1e-12);
    EXPECT_EQ(front_class(front, joint), "drawer");
  }
}

TEST(JointPrior, AFlapAtThePlinthReachesTheWorktop) {
  const Front dishwasher = front_with_bar(0.6, 0.72, 0.48, 0, 0.29);
  EXPECT_EQ(front_class(dishwasher, joint_prior(dishwasher)), "flap");
  const Front below_a_drawer = front_with_bar(0.6, 0.57, 0.42, 0, 0.23);
  EXPECT_EQ(front_class(below_a_drawer, joint_prior(below_a_drawer)), "drawer");
  const Front oven = front_with_bar(0.6, 0.55, 1.1, 0, 0.23);
  EXPECT_EQ(front_class(oven, joint_prior(oven)), "flap");
}

TEST(JointPrior, ANarrowHighFrontHeldInTheMiddleIsAPullOut) {
  Front pull_out = front_with_bar(0.3, 1.3, 0.8, 0, 0, true);
  pull_out.fixture->length = 1.2;
  const JointEstimate joint = joint_prior(pull_out);
  EXPECT_EQ(joint.type, ArticulationType::prismatic);
  EXPECT_NEAR(joint.axis.dot(pull_out.normal), 1, 1e-12);
  const Front door = front_with_bar(0.3, 1.3, 0.8, 0.11, 0, true);
  EXPECT_EQ(front_class(door, joint_prior(door)), "door");
}

TEST(JointPrior, UprightBarNearAnEdgeIsADoorHingedAtTheOther) {
  for (const double side : {-0.24, 0.24}) {
    const Front front = front_with_bar(0.6, 1.3, 1.5, side, 0, true);
    const JointEstimate joint = joint_prior(front);
    EXPECT_EQ(joint.type, ArticulationType::revolute);
    EXPECT_EQ(front_class(front, joint), "door");
    EXPECT_NEAR((joint.origin - front.centre).dot(front.right()), side > 0 ? -0.3 : 0.3, 1e-9);
    EXPECT_GT(opening_direction(front, joint).dot(front.normal), 0.99);
    EXPECT_GE(joint.upper, 1.57);
    EXPECT_LT(joint.axis_sd_deg, 20);
  }
}

TEST(JointPrior, LevelBarAtTheSideOfATallFrontIsADoorToo) {
  const JointEstimate joint = joint_prior(front_with_bar(0.6, 0.8, 0.5, 0.15, 0.26));
  EXPECT_EQ(joint.type, ArticulationType::revolute);
  EXPECT_LT(joint.axis.z(), -0.99);
}

TEST(JointPrior, BarAtTheTopOfATallLowFrontIsAFlapHingedBelow) {
  const Front front = front_with_bar(0.6, 0.75, 0.5, 0, 0.32);
  const JointEstimate joint = joint_prior(front);
  EXPECT_EQ(joint.type, ArticulationType::revolute);
  EXPECT_EQ(front_class(front, joint), "flap");
  EXPECT_LT((joint.origin - front.centre).dot(front.up), -0.3);
  EXPECT_GT(opening_direction(front, joint).dot(front.normal), 0.99);
}

TEST(JointPrior, BarAtTheBottomOfAWallCupboardLiftsIt) {
  const Front front = front_with_bar(0.9, 0.4, 1.7, 0, -0.16);
  const JointEstimate joint = joint_prior(front);
  EXPECT_EQ(joint.type, ArticulationType::revolute);
  EXPECT_EQ(front_class(front, joint), "flap");
  EXPECT_GT((joint.origin - front.centre).dot(front.up), 0.15);
  EXPECT_GT(opening_direction(front, joint).dot(front.normal), 0.99);
}

TEST(JointPrior, KnobsAreReadByTheirPlaceAndTheFrontsShape) {
  EXPECT_EQ(joint_prior(front_with_knob(0.5, 0.18, 0.75, 0, 0)).type, ArticulationType::prismatic);
  const JointEstimate door = joint_prior(front_with_knob(0.45, 0.7, 1.6, -0.19, -0.25));
  EXPECT_EQ(door.type, ArticulationType::revolute);
  EXPECT_GT(door.axis.z(), 0.99);
}

TEST(JointPrior, OvenDoorIsAFlapThoughItsHandleWouldSuitADrawer) {
  Front front = front_with_bar(0.6, 0.45, 0.5, 0, 0.18);
  EXPECT_EQ(joint_prior(front).type, ArticulationType::prismatic);
  front.appliance = "oven";
  EXPECT_EQ(front_class(front, joint_prior(front)), "flap");
}

TEST(JointPrior, WithoutFixtureTheTypeStaysOpen) {
  Front front = front_with_bar(0.55, 0.5, 0.5, 0, 0);
  front.fixture.reset();
  const JointEstimate joint = joint_prior(front);
  for (const double p : joint.probabilities) EXPECT_LT(p, 0.75);
  EXPECT_GT(probability(joint, ArticulationType::rigid), 0.1);
}

TEST(JointPrior, SideOfTheHingeIsUncertainWhenTheBarIsInTheMiddle) {
  const JointEstimate joint = joint_prior(front_with_bar(0.5, 2.0, 1.1, 0, 0, true));
  ASSERT_EQ(joint.type, ArticulationType::revolute);
  EXPECT_GT(joint.axis_sd_deg, 90);
  EXPECT_GT(joint.origin_sd_m, 0.2);
}

TEST(JointPrior, ProbabilitiesSumToOneForAnyShape) {
  for (const double width : {0.0, 0.01, 0.3, 1.0, 5.0})
    for (const double height : {0.0, 0.01, 0.3, 1.0, 5.0}) {
      const JointEstimate joint = joint_prior(front_with_bar(width, height, 1, 0.3 * width, -0.4 * height));
      EXPECT_NEAR(std::accumulate(joint.probabilities.begin(), joint.probabilities.end(), 0.0), 1, 1e-12);
      EXPECT_TRUE(joint.axis.allFinite() && joint.origin.allFinite());
    }
}

/// Every front with a handle that truth.json lists; the joint's type is known there.
TEST(JointPrior, MostTypesOfTheApartmentAreRightBeforeAnythingIsTouched) {
  const auto path = std::filesystem::path(LOCI_SHARED_DIR) / "data/iai_apartment/truth.json";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const auto vector = [](const Json& v) {
    return Vector3d(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  const Json truth = read_json(path);
  size_t right = 0, fronts = 0, hinges_right = 0, hinges = 0;
  for (const Json& handle : truth["handles"]) {
    for (const Json& joint : truth["joints"]) {
      if (joint["child"] != handle["front_link"] || joint["front"].is_null()) continue;
      const Json& rectangle = joint["front"];
      Front front;
      front.centre = vector(rectangle["centre"]);
      front.normal = vector(rectangle["normal"]);
      front.up = vector(rectangle["up"]);
      front.width = rectangle["width"].get<double>();
      front.height = rectangle["height"].get<double>();
      front.fixture = Fixture{};
      front.fixture->centre = vector(handle["bar_centre"]);
      front.fixture->axis = vector(handle["axis"]);
      front.fixture->length = handle["length"].get<double>();
      const JointEstimate prior = joint_prior(front);
      ++fronts;
      if (joint["type"] != to_text(prior.type)) continue;
      ++right;
      if (prior.type != ArticulationType::revolute) continue;
      ++hinges;
      const Vector3d axis = vector(joint["axis"]);
      const Vector3d off = vector(joint["origin"]) - prior.origin;
      // A folding lift door's lower half turns against its upper half: only the line of the hinge counts.
      if (std::abs(axis.dot(prior.axis)) > 0.99 && off.cross(axis).norm() < 0.05) ++hinges_right;
    }
  }
  ASSERT_GT(fronts, 20u);
  EXPECT_GE(static_cast<double>(right), 0.85 * static_cast<double>(fronts)) << right << " of " << fronts;
  EXPECT_EQ(hinges_right, hinges);
  RecordProperty("right", static_cast<int>(right));
  RecordProperty("fronts", static_cast<int>(fronts));
}

}  // namespace
}  // namespace loci::mapping
