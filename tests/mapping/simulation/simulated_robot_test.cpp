#include "mapping/simulation/simulated_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <numbers>
#include <regex>

#include "mapping/base/files.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// A cabinet along the wall x = 3: a drawer at y = 0, a door at y = 1 (hinge at y = 1.3, opens by 90
/// degrees), a lid that follows the door, and a cupboard that opens backwards (negative positions).
constexpr const char* kCabinet = R"(<robot name="cabinet">
  <link name="map"/>
  <link name="wall"><visual><origin xyz="3.5 0 1"/><geometry><box size="0.1 6 2"/></geometry></visual></link>
  <joint name="wall_joint" type="fixed"><parent link="map"/><child link="wall"/></joint>
  <link name="drawer"><visual><geometry><box size="0.02 0.6 0.3"/></geometry></visual></link>
  <joint name="drawer_joint" type="prismatic"><parent link="map"/><child link="drawer"/>
    <origin xyz="3 0 0.7"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
  <link name="drawer_handle"><visual><geometry><box size="0.01 0.2 0.01"/></geometry></visual></link>
  <joint name="drawer_handle_joint" type="fixed"><parent link="drawer"/><child link="drawer_handle"/>
    <origin xyz="-0.045 0 0"/></joint>
  <link name="door"><visual><origin xyz="0 -0.3 0"/><geometry><box size="0.02 0.6 0.6"/></geometry></visual></link>
  <joint name="door_joint" type="revolute"><parent link="map"/><child link="door"/>
    <origin xyz="3 1.3 0.7"/><axis xyz="0 0 -1"/><limit lower="0" upper="1.5708" effort="1" velocity="1"/></joint>
  <link name="door_handle"><visual><geometry><box size="0.01 0.01 0.2"/></geometry></visual></link>
  <joint name="door_handle_joint" type="fixed"><parent link="door"/><child link="door_handle"/>
    <origin xyz="-0.045 -0.5 0"/></joint>
  <link name="lid"><visual><geometry><box size="0.02 0.2 0.2"/></geometry></visual></link>
  <joint name="lid_joint" type="prismatic"><parent link="map"/><child link="lid"/><origin xyz="3 2 1.2"/>
    <axis xyz="-1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="door_joint" multiplier="0.1"/></joint>
  <link name="backwards"><visual><geometry><box size="0.02 0.6 0.3"/></geometry></visual></link>
  <joint name="backwards_joint" type="prismatic"><parent link="map"/><child link="backwards"/>
    <origin xyz="3 -1 0.7"/><axis xyz="1 0 0"/><limit lower="-0.3" upper="0" effort="1" velocity="1"/></joint>
</robot>)";

class ScannedCabinet : public testing::Test {
 protected:
  ScannedCabinet() : folder_(fs::temp_directory_path() / ("loci_cabinet_" + std::to_string(getpid()))) {
    make_folder(folder_);
    write_file_atomically(folder_ / "cabinet.urdf", kCabinet);
  }
  ~ScannedCabinet() override { fs::remove_all(folder_); }

  static SimulatedRobotOptions coarse() {
    SimulatedRobotOptions options;
    options.laser.tilt_step_deg = options.laser.azimuth_step_deg = 1;
    options.hand = {0, 0};
    return options;
  }
  SimulatedRobot robot(const SimulatedRobotOptions& options = coarse()) {
    return {folder_ / "cabinet.urdf", options, {0, 0, 0}, warnings_};
  }

  fs::path folder_;
  Warnings warnings_;
};

TEST_F(ScannedCabinet, DrawerComesOutByTheWayOfTheHand) {
  SimulatedRobot world = robot();
  const PullResult pulled = world.pull({2.955, 0, 0.7}, 0.25);
  EXPECT_EQ(pulled.link, "drawer_handle");
  EXPECT_EQ(pulled.joint, "drawer_joint");
  EXPECT_NEAR(pulled.moved, 0.25, 1e-9);
  EXPECT_NEAR(world.joints().at("drawer_joint"), 0.25, 1e-9);
  const Vector3d way = pulled.hand_path.back().translation() - pulled.hand_path.front().translation();
  EXPECT_LT((way - Vector3d(-0.25, 0, 0)).norm(), 1e-9);
}

TEST_F(ScannedCabinet, DrawerStopsAtItsLimit) {
  SimulatedRobot world = robot();
  EXPECT_NEAR(world.pull({2.955, 0, 0.7}, 1).moved, 0.4, 1e-9);
  const PullResult again = world.pull({2.555, 0, 0.7}, 1);
  EXPECT_EQ(again.link, "drawer_handle");
  EXPECT_EQ(again.joint, "");
  EXPECT_EQ(again.moved, 0);
}

TEST_F(ScannedCabinet, HandFollowsTheDoorOnAnArc) {
  SimulatedRobot world = robot();
  const PullResult pulled = world.pull({2.955, 0.8, 0.7}, 0.3);
  EXPECT_EQ(pulled.joint, "door_joint");
  const Vector3d hinge(3, 1.3, 0);
  const Vector3d first = pulled.hand_path.front().translation();
  const double radius = (first - hinge).head<2>().norm();
  EXPECT_NEAR(pulled.moved, 0.3 / radius, 1e-3);
  double length = 0;
  for (size_t i = 1; i < pulled.hand_path.size(); ++i) {
    const Vector3d hand = pulled.hand_path[i].translation();
    EXPECT_NEAR((hand - hinge).head<2>().norm(), radius, 1e-9);
    EXPECT_NEAR(hand.z(), first.z(), 1e-9);
    length += (hand - pulled.hand_path[i - 1].translation()).norm();
  }
  EXPECT_NEAR(length, 0.3, 1e-3);
  EXPECT_LT(pulled.hand_path.back().translation().x(), first.x());  // Into the room.
  const Isometry3d turn = pulled.hand_path.front().inverse() * pulled.hand_path.back();
  EXPECT_NEAR(Eigen::AngleAxisd(turn.linear()).angle(), pulled.moved, 1e-9);
}

TEST_F(ScannedCabinet, JointThatOpensBackwardsAndTheOneThatIsMimickedMove) {
  SimulatedRobot world = robot();
  const PullResult backwards = world.pull({2.99, -1, 0.7}, 0.2);
  EXPECT_EQ(backwards.joint, "backwards_joint");
  EXPECT_NEAR(backwards.moved, 0.2, 1e-9);
  EXPECT_NEAR(world.joints().at("backwards_joint"), -0.2, 1e-9);
  const PullResult lid = world.pull({2.99, 2, 1.2}, 0.05);
  EXPECT_EQ(lid.link, "lid");
  EXPECT_EQ(lid.joint, "door_joint");
  EXPECT_NEAR(lid.moved, 0.5, 1e-6);  // Ten times the way of the lid.
}

TEST_F(ScannedCabinet, WallDoesNotMoveAndAirIsNothing) {
  SimulatedRobot world = robot();
  const PullResult wall = world.pull({3.44, 2.9, 1}, 0.2);
  EXPECT_EQ(wall.link, "wall");
  EXPECT_EQ(wall.joint, "");
  EXPECT_TRUE(world.joints().empty());
  EXPECT_EQ(world.pull({1, 1, 1}, 0.2).link, "");
}

TEST_F(ScannedCabinet, OpenDrawerIsSeenAndClosesAgain) {
  SimulatedRobot world = robot();
  const auto ahead = [](const Scan& scan) {  // Beams that point at the handle.
    double nearest = 10;
    for (const ScanPoint& point : scan.points)
      if (std::abs(point.position.y()) < 0.1f && std::abs(point.position.z() + 0.55f) < 0.12f)
        nearest = std::min(nearest, static_cast<double>(point.position.x()));
    return nearest;
  };
  const double closed = ahead(world.scan_at({0, 0, 0}));
  world.pull({2.955, 0, 0.7}, 0.3);
  const double open = ahead(world.scan_at({0, 0, 0}));
  EXPECT_NEAR(closed - open, 0.3, 0.06);
  world.close_all();
  EXPECT_NEAR(ahead(world.scan_at({0, 0, 0})), closed, 0.06);
  EXPECT_TRUE(world.joints().empty());
}

TEST_F(ScannedCabinet, FirstPoseIsExactAndLaterOnesDriftUntilLocalised) {
  SimulatedRobot world = robot();
  const Scan first = world.scan_at({0, 0, 0});
  EXPECT_TRUE(first.map_from_scan.isApprox(world.true_map_from_scanner(), 1e-12));
  EXPECT_TRUE(first.covariance.isZero(0));
  EXPECT_EQ(first.name, "scan_000");
  const Scan second = world.scan_at({1.5, 0.5, 1});
  const Isometry3d error = world.true_map_from_scanner().inverse() * second.map_from_scan;
  EXPECT_GT(error.translation().norm(), 1e-4);
  EXPECT_LT(error.translation().norm(), 6 * std::sqrt(second.covariance(0, 0)));
  EXPECT_NEAR(second.map_from_scan.translation().x(), 1.5, 1e-12);  // It believes to be there.
  world.localize(world.true_pose());
  const Scan third = world.scan_at(world.true_pose());
  EXPECT_TRUE(third.map_from_scan.isApprox(world.true_map_from_scanner(), 1e-9));
  EXPECT_TRUE(third.covariance.isZero(1e-20));
}

TEST_F(ScannedCabinet, CovarianceTellsHowFarOffTheRobotIs) {
  // Over many seeds the squared Mahalanobis distance after two moves has three degrees of freedom.
  double sum = 0;
  const int runs = 60;
  for (int seed = 0; seed < runs; ++seed) {
    SimulatedRobotOptions options = coarse();
    options.laser.tilt_step_deg = options.laser.azimuth_step_deg = 10;
    options.seed = static_cast<uint64_t>(seed);
    SimulatedRobot world = robot(options);
    world.scan_at({1.5, 0, 0.5});
    const Scan scan = world.scan_at({0.5, 1.5, -0.5});
    const PlanarPose believed = planar(scan.map_from_scan), truth = world.true_pose();
    const Vector3d error(believed.x - truth.x, believed.y - truth.y, believed.yaw - truth.yaw);
    Eigen::Matrix3d covariance;
    const std::array<int, 3> rows = {0, 1, 5};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        covariance(i, j) = scan.covariance(rows[static_cast<size_t>(i)], rows[static_cast<size_t>(j)]);
    sum += error.dot(covariance.inverse() * error);
  }
  EXPECT_NEAR(sum / runs, 3, 4 * std::sqrt(6. / runs));
}

TEST_F(ScannedCabinet, PoseErrorAppliesToTheHand) {
  SimulatedRobotOptions options = coarse();
  SimulatedRobot world = robot(options);
  world.localize({0, 0.3, 0});  // It believes to stand 30 cm beside where it is.
  EXPECT_EQ(world.pull({2.955, 1.1, 0.7}, 0.1).link, "door_handle");
}

TEST_F(ScannedCabinet, GoalInsideTheFurnitureIsRefusedAndTheRobotStays) {
  SimulatedRobot world = robot();
  const Scan before = world.scan_at({1, 0, 0});
  try {
    world.scan_at({2.9, 0, 0});
    FAIL() << "it stands in the drawer";
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("drawer"), std::string::npos) << error.message();
  }
  const Scan after = world.scan_at({1, 0, 0});
  EXPECT_TRUE(before.map_from_scan.isApprox(after.map_from_scan));
  EXPECT_NEAR(before.covariance(5, 5), after.covariance(5, 5), 1e-15);
}

TEST_F(ScannedCabinet, FloorAndCeilingAreAddedOnDemand) {
  const auto extent = [&](std::optional<double> floor, std::optional<double> ceiling) {
    SimulatedRobotOptions options = coarse();
    options.floor = floor;
    options.ceiling = ceiling;
    float low = 10, high = -10;
    for (const ScanPoint& point : robot(options).scan_at({2, 0, 0}).points) {
      if (!point.returned) continue;
      low = std::min(low, point.position.z());
      high = std::max(high, point.position.z());
    }
    return std::pair(low, high);
  };
  EXPECT_NEAR(extent(-0.3, 2.6).first, -1.25, 0.05);
  EXPECT_NEAR(extent(-0.3, 2.6).second, 1.65, 0.05);
  EXPECT_GT(extent({}, {}).first, -1.3);
  EXPECT_LT(extent({}, {}).second, 0.8);
}

TEST_F(ScannedCabinet, AFloorThatIsNotAtZeroIsThatOfTheMap) {
  const std::string lifted = std::regex_replace(
      std::string(kCabinet), std::regex("<link name=\"map\"/>"),
      "<link name=\"world\"/><link name=\"map\"/><joint name=\"lift\" type=\"fixed\"><parent link=\"world\"/>"
      "<child link=\"map\"/><origin xyz=\"0 0 0.75\"/></joint>");
  write_file_atomically(folder_ / "lifted.urdf", lifted);
  SimulatedRobotOptions options = coarse();
  SimulatedRobot low = robot(options);
  options.floor = 0.75;
  SimulatedRobot high(folder_ / "lifted.urdf", options, {0, 0, 0}, warnings_);
  EXPECT_EQ(high.map_from_world().translation(), Vector3d(0, 0, -0.75));
  const Scan below = low.scan_at({1, 0, 0}), above = high.scan_at({1, 0, 0});
  ASSERT_EQ(below.points.size(), above.points.size());
  EXPECT_TRUE(below.map_from_scan.isApprox(above.map_from_scan));
  for (size_t i = 0; i < below.points.size(); i += 97)
    EXPECT_NEAR((below.points[i].position - above.points[i].position).norm(), 0, 1e-4F);
  const PullResult pulled = high.pull({2.955, 0, 0.7}, 0.2);  // In the map's frame.
  EXPECT_EQ(pulled.joint, "drawer_joint");
  EXPECT_NEAR(pulled.hand_path.back().translation().z(), 0.7, 1e-6);
}

TEST_F(ScannedCabinet, TheFloorIsTheWorldsOwnUnlessItIsGiven) {
  const auto floor_of = [&](const std::string& links, const std::string& asked) {
    write_file_atomically(folder_ / "low.urdf",
                          "<robot name=\"r\"><link name=\"map\"/>" + links + "</robot>");
    return floor_of_world(asked, folder_ / "low.urdf", {}, warnings_);
  };
  const auto slab = [](const std::string& name, double top) {
    return "<link name=\"" + name + "\"><visual><origin xyz=\"0 0 " + std::to_string(top - 0.05) +
           "\"/><geometry><box size=\"4 3 0.1\"/></geometry></visual></link><joint name=\"" + name +
           "_joint\" type=\"fixed\"><parent link=\"map\"/><child link=\"" + name + "\"/></joint>";
  };
  EXPECT_NEAR(*floor_of(slab("floor", -0.45) + slab("cellar", -3), "auto"), -0.45, 1e-9);
  EXPECT_NEAR(*floor_of(slab("boden", -0.45) + slab("decke", 2), "auto"), -0.45, 1e-9);
  EXPECT_EQ(floor_of(slab("floor", 0.002), "auto"), 0);  // As measured ones are.
  EXPECT_EQ(floor_of(slab("floor", -0.45), "0.3"), 0.3);
  EXPECT_EQ(floor_of(slab("floor", -0.45), "none"), std::nullopt);
  EXPECT_THROW(floor_of(slab("floor", -0.45), "low"), Error);
  EXPECT_TRUE(warnings_.empty());
  write_file_atomically(folder_ / "low.urdf", R"(<robot name="r"><link name="post"><visual>
    <origin xyz="0 0 -0.5"/><geometry><sphere radius="0.5"/></geometry></visual></link></robot>)");
  EXPECT_EQ(floor_of_world("auto", folder_ / "low.urdf", {}, warnings_), 0);
  EXPECT_THAT(warnings_.texts().at(0), testing::HasSubstr("reaches down to -1.00 m"));
}

TEST_F(ScannedCabinet, WithoutWallsItStartsBesideTheFurnitureAndLooksAtIt) {
  write_file_atomically(folder_ / "table.urdf", R"(<robot name="r"><link name="table"><visual>
    <origin xyz="5 2 0.4"/><geometry><box size="1.6 0.8 0.8"/></geometry></visual></link></robot>)");
  const SimulatedRobot beside(folder_ / "table.urdf", coarse(), {0, 0, 0}, warnings_);
  const PlanarPose start = beside.open_place();
  const Vector2d to_table = Vector2d(5, 2) - Vector2d(start.x, start.y);
  EXPECT_NEAR(to_table.norm(), 1.6, 0.3);
  EXPECT_GT(to_table.normalized().dot(Vector2d(std::cos(start.yaw), std::sin(start.yaw))), 0.99);
}

TEST_F(ScannedCabinet, AWorldInMillimetresIsRefused) {
  write_file_atomically(folder_ / "large.urdf",
                        R"(<robot name="r"><link name="room"><visual><geometry><box size="4000 3000 2500"/>
      </geometry></visual></link></robot>)");
  try {
    SimulatedRobot(folder_ / "large.urdf", coarse(), {0, 0, 0}, warnings_);
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("4000 x 3000 x 2500 m"));
    EXPECT_THAT(error.hint(), testing::HasSubstr("scale"));
  }
}

TEST_F(ScannedCabinet, JointsCanBeSetWithinTheirLimits) {
  SimulatedRobot world = robot();
  world.set_joints({{"drawer_joint", 0.2}});
  EXPECT_EQ(world.joints().at("drawer_joint"), 0.2);
  EXPECT_THROW(world.set_joints({{"drawer_joint", 0.5}}), Error);
  EXPECT_THROW(world.set_joints({{"no_joint", 0.1}}), Error);
  EXPECT_EQ(world.joints().size(), 1u);
}

}  // namespace
}  // namespace loci::mapping
