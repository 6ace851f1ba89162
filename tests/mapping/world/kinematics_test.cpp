#include "mapping/world/kinematics.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

World arm() {
  return parse_urdf(
      R"(<robot name="arm"><link name="tip"/><link name="upper"/><link name="base"/><link name="lamp"/>
    <joint name="elbow" type="prismatic"><parent link="upper"/><child link="tip"/><origin xyz="1 0 0"/><axis xyz="2 0 0"/>
      <limit lower="0" upper="1" effort="1" velocity="1"/></joint>
    <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
      <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
    <joint name="follower" type="continuous"><parent link="base"/><child link="lamp"/><axis xyz="0 0 1"/>
      <mimic joint="shoulder" multiplier="-2" offset="0.5"/></joint></robot>)",
      "arm.urdf");
}

TEST(Kinematics, JointsMoveWhatHangsBelowThem) {
  const World world = arm();
  const auto poses = root_from_links(world, {{"shoulder", kPi / 2}, {"elbow", 0.25}});
  EXPECT_TRUE(poses[world.link_index("base")].isApprox(Isometry3d::Identity()));
  EXPECT_TRUE(poses[world.link_index("tip")].translation().isApprox(Vector3d(0, 1.25, 1), 1e-12));
  EXPECT_TRUE(poses[world.link_index("tip")].linear().col(0).isApprox(Vector3d::UnitY(), 1e-12));
}

TEST(Kinematics, JointsThatAreNotNamedAreAtZero) {
  const World world = arm();
  EXPECT_TRUE(root_from_links(world, {})[world.link_index("tip")].translation().isApprox(Vector3d(1, 0, 1)));
}

TEST(Kinematics, MimicJointsFollowWithMultiplierAndOffset) {
  const World world = arm();
  const size_t lamp = world.link_index("lamp");
  const Eigen::AngleAxisd turn(root_from_links(world, {{"shoulder", 0.1}, {"follower", 9}})[lamp].linear());
  EXPECT_NEAR(turn.angle() * turn.axis().z(), -2 * 0.1 + 0.5, 1e-12);
}

TEST(Kinematics, UnknownJointIsRefusedWithTheNearestName) {
  try {
    root_from_links(arm(), {{"sholder", 1}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'shoulder'"));
  }
  EXPECT_THROW(root_from_links(arm(), {{"shoulder", std::nan("")}}), Error);
}

TEST(Kinematics, AStateIsReducedToTheJointsOfTheWorld) {
  EXPECT_EQ(joints_of_world(arm(), {{"head_pan", 0.3}, {"shoulder", 0.1}}), (JointState{{"shoulder", 0.1}}));
}

TEST(Kinematics, UnknownLinkIsRefusedWithTheNearestName) {
  try {
    arm().link_index("uper");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'upper'"));
  }
}

TEST(Kinematics, ApartmentJointsAreWhereTheTruthSays) {
  const std::filesystem::path folder = std::filesystem::path(LOCI_SHARED_DIR) / "data" / "iai_apartment";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  const World world = read_urdf(folder / "apartment.urdf");
  EXPECT_EQ(world.links.size(), 117u);
  const auto poses = root_from_links(world, {});
  const Json all = read_json(folder / "truth.json");
  EXPECT_EQ(all["joints"].size(), 42u);
  for (const Json& truth : all["joints"]) {
    const Joint* joint = world.find_joint(truth["name"]);
    ASSERT_NE(joint, nullptr);
    const Isometry3d& pose = poses[world.link_index(joint->child)];
    const Vector3d axis = pose.linear() * joint->axis.normalized();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(pose.translation()[k], truth["origin"][static_cast<size_t>(k)].get<double>(), 1e-4)
          << joint->name;
      EXPECT_NEAR(axis[k], truth["axis"][static_cast<size_t>(k)].get<double>(), 1e-4) << joint->name;
    }
  }
}

TEST(Kinematics, LinksBelowAMovableJointMove) {
  const World world = arm();
  const std::vector<bool> moving = moving_links(world);
  EXPECT_TRUE(moving[world.link_index("tip")]);
  EXPECT_TRUE(moving[world.link_index("upper")]);
  EXPECT_FALSE(moving[world.link_index("base")]);
}

}  // namespace
}  // namespace loci::mapping
