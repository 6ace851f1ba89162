#include "nbv/survey.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <set>

#include "mapping/simulation/simulated_robot.h"
#include "mapping/world/urdf.h"
#include "tests/nbv/small_world.h"

namespace loci::nbv::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Stops a survey when it says so for the n-th time.
class StopAfter : public Progress {
 public:
  explicit StopAfter(int checks) : left_(checks) {}
  bool update(double, std::string_view) override { return --left_ >= 0; }

 private:
  int left_;
};

/// A cupboard with two drawers one above the other, joined: one does not open without the other.
SmallWorld drawers_that_hang_together() {
  SmallWorld world;
  world.box("cupboard", {0, 1.26, 0.45}, {1.2, 0.48, 0.8});
  world.box("top", {0, 1.24, 0.87}, {1.24, 0.54, 0.04});
  world.drawer("upper", 0, 1, 0.65, 0.8, 0.38);
  world.drawer("lower", 0, 1, 0.26, 0.8, 0.38, "<mimic joint='upper_joint'/>");
  return world;
}

class Survey : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "survey" /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  SurveyResult explore(const SmallWorld& world, const std::string& out, int threads, Progress& progress,
                       bool resume = false, const mapping::PlanarPose& start = {0, -0.4, kPi / 2}) {
    SurveyOptions options;
    options.interact = true;
    options.exploration.max_scans = 3;
    options.exploration.threads = threads;
    mapping::SimulatedRobotOptions simulated;
    simulated.threads = threads;
    mapping::SimulatedRobot robot(world.write(folder_), simulated, start, warnings_);
    return survey(robot, start, folder_ / out, resume, options, progress, warnings_);
  }
  std::string bytes(const std::string& file) const { return read_file(folder_ / file); }

  fs::path folder_;
  Warnings warnings_;
  NoProgress quiet_;
};

TEST_F(Survey, GoesOnAfterInterruptionsAsIfThereHadBeenNone) {
  const SmallWorld world = drawers_that_hang_together();
  const SurveyResult whole = explore(world, "whole/room", 2, quiet_);
  EXPECT_FALSE(whole.interactions.empty());
  // Stopped in the exploration, and once more where it pulls; other numbers of threads.
  StopAfter soon(2);
  EXPECT_THROW(explore(world, "parts/room", 1, soon), Interrupted);
  class StopAtSecondPull : public Progress {
   public:
    bool update(double, std::string_view text) override {
      return !text.starts_with("pulls ") || ++pulls_ < 2;
    }

   private:
    int pulls_ = 0;
  } later;
  EXPECT_THROW(explore(world, "parts/room", 2, later, true), Interrupted);
  explore(world, "parts/room", 1, quiet_, true);
  for (const char* file : {"map.urdf", "map.semantic.json"})
    EXPECT_EQ(bytes(std::string("parts/room/") + file), bytes(std::string("whole/room/") + file)) << file;
  EXPECT_EQ(mapping::read_urdf(folder_ / "whole/room/map.urdf").name, "room");
}

TEST_F(Survey, FrontsThatShareAJointAreEachMappedAsTheDrawersThatTheyAre) {
  const SurveyResult result = explore(drawers_that_hang_together(), "map", 0, quiet_);
  ASSERT_EQ(result.map.fronts.size(), 2U);
  for (const mapping::Front& front : result.map.fronts) {
    EXPECT_EQ(front.class_name, "drawer");
    ASSERT_TRUE(front.joint);
    EXPECT_EQ(front.joint->type, mapping::ArticulationType::prismatic);
    EXPECT_GT(-front.joint->axis.y(), 0.999) << front.joint->axis.transpose();
    EXPECT_NEAR(front.width, 0.8, 0.03);
    EXPECT_NEAR(front.height, 0.38, 0.03);
  }
  EXPECT_EQ(result.interactions.size(), 2U);
  for (const Interaction& pull : result.interactions) EXPECT_TRUE(pull.held) << pull.pulled_as;
}

TEST_F(Survey, PullsHaveTheNamesThatFrontsGetWhenTheyAreNumberedAnew) {
  SmallWorld world;
  world.box("cupboard", {0, 1.26, 0.45}, {1.2, 0.48, 0.8});
  world.box("top", {0, 1.24, 0.87}, {1.24, 0.54, 0.04});
  world.flap("upper", 0, 1, 0.65, 0.8, 0.38);  // Taken for a drawer until it is pulled.
  world.drawer("lower", 0, 1, 0.26, 0.8, 0.38);
  const SurveyResult result = explore(world, "map", 0, quiet_);
  ASSERT_EQ(result.interactions.size(), 2U);
  std::set<std::string> names;
  for (const Interaction& pull : result.interactions) {
    ASSERT_TRUE(pull.front) << pull.pulled_as;
    ASSERT_TRUE(pull.difference.joint) << pull.difference.reason;
    names.insert(pull.pulled_as + " is " + *pull.front);
    const auto front = std::ranges::find(result.map.fronts, *pull.front, &mapping::Front::name);
    ASSERT_NE(front, result.map.fronts.end()) << *pull.front;
    EXPECT_EQ(front->joint->type, pull.difference.joint->type) << *pull.front;
  }
  EXPECT_THAT(names, testing::ElementsAre("drawer_1 is flap_1", "drawer_2 is drawer_1"));
  EXPECT_EQ(result.report()["interactions"][0]["pulled_as"], result.interactions[0].pulled_as);
}

TEST_F(Survey, WhatDidNotGiveWayHasNoJointAndIsUncertain) {
  SmallWorld world;
  world.box("cupboard", {0, 1.26, 0.45}, {1.2, 0.48, 0.8});
  world.box("top", {0, 1.24, 0.87}, {1.24, 0.54, 0.04});
  world.fixed_front("upper", 0, 1, 0.65, 0.8, 0.38);
  world.drawer("lower", 0, 1, 0.26, 0.8, 0.38);
  const SurveyResult result = explore(world, "map", 0, quiet_);
  ASSERT_EQ(result.map.fronts.size(), 2U);
  const auto upper = std::ranges::max_element(result.map.fronts, {},
                                              [](const mapping::Front& front) { return front.centre.z(); });
  EXPECT_EQ(upper->class_name, "front");
  EXPECT_FALSE(upper->joint && upper->joint->type != mapping::ArticulationType::rigid);
  EXPECT_THAT(bytes("map/report.html"), HasSubstr("was not seen to open when it was pulled"));
}

TEST_F(Survey, WhatComesOutTogetherSideBySideIsOneDrawer) {
  SmallWorld world;
  world.box("cupboard", {0, 1.26, 0.45}, {1.2, 0.48, 0.8});
  world.box("top", {0, 1.24, 0.87}, {1.24, 0.54, 0.04});
  world.two_bar_drawer("upper", 0, 1, 0.65, 1, 0.38);
  world.drawer("lower", 0, 1, 0.26, 1, 0.38);
  const SurveyResult result = explore(world, "map", 0, quiet_);
  EXPECT_EQ(result.fronts_before.size(), 3U);
  ASSERT_EQ(result.map.fronts.size(), 2U);
  EXPECT_EQ(result.interactions.size(), 2U);
  const mapping::Front& front = result.map.fronts.front();
  EXPECT_NEAR(front.width, 1, 0.04);
  EXPECT_NEAR(front.centre.x(), 0, 0.02);
  EXPECT_NEAR(front.fixture->length, 0.8, 0.04);
  EXPECT_EQ(front.joint->type, mapping::ArticulationType::prismatic);
}

TEST_F(Survey, IsNotUsableWhenMostScansCouldNotBeRegistered) {
  SurveyResult result;
  result.steps.resize(40);
  result.scans.scans.resize(2);
  EXPECT_FALSE(result.usable());
  result.scans.scans.resize(30);
  EXPECT_TRUE(result.usable());
}

TEST_F(Survey, SaysThatItCannotStartInsideFurniture) {
  try {
    explore(drawers_that_hang_together(), "map", 0, quiet_, false, {0, 1.2, 0});
    FAIL() << "it started in the cupboard";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'cupboard' is in the way"));
    EXPECT_FALSE(error.hint().empty());
  }
}

}  // namespace
}  // namespace loci::nbv::test
