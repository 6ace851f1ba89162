#include "nbv/base_poses.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapping/occupancy/box_room.h"

namespace loci::nbv {
namespace {

/// A cupboard along the east wall; a screen as high as the room stands before its southern half.
mapping::BoxRoom room_with_screen() {
  mapping::BoxRoom room;
  room.room = {Vector3d(-3, -2, 0), Vector3d(3, 2, 2.8)};
  room.furniture = {{Vector3d(2.4, -1.5, 0), Vector3d(3, 1.5, 0.9)},
                    {Vector3d(1.4, -1.9, 0), Vector3d(1.5, 0, 2)}};
  return room;
}

mapping::OccupancyMap mapped(const mapping::BoxRoom& room) {
  mapping::OccupancyMap map({0.05, 7, 2});
  for (const mapping::PlanarPose& pose :
       {mapping::PlanarPose{-1, 0, 0}, {0.5, 1.3, 0}, {1.9, 0.8, -kPi / 2}, {0.5, -1, 0}}) {
    Isometry3d scanner = map_from_base(pose);
    scanner.translation().z() = mapping::LaserModel().height_m;
    map.insert(room.sweep(scanner, 720, 240, 10, 0, 3, 60));
  }
  return map;
}

mapping::Front front_at(double y) {
  mapping::Front front;
  front.centre = {2.4, y, 0.5};
  front.normal = -Vector3d::UnitX();
  front.width = 0.5;
  front.height = 0.6;
  front.fixture = mapping::Fixture();
  front.fixture->centre = {2.36, y, 0.7};
  return front;
}

BasePosePlanner planner_for(const mapping::OccupancyMap& map) {
  return BasePosePlanner(map, {-1, 0, 0}, mapping::LaserModel(), {}, {}, 0.3);
}

TEST(Stops, LookAtTheFrontsFromWhereNothingHidesThem) {
  const mapping::BoxRoom room = room_with_screen();
  const mapping::OccupancyMap map = mapped(room);
  const std::vector<mapping::Front> fronts = {front_at(1.0), front_at(-0.5)};
  bool first_served = false;
  for (const BasePose& stop : planner_for(map).plan(fronts))
    for (const size_t front : stop.fronts) {
      first_served = first_served || front == 0;
      const Vector3d from(stop.pose.x, stop.pose.y, mapping::LaserModel().height_m),
          way = fronts[front].fixture->centre - from;
      EXPECT_GE(room.cast(from, way.normalized()), way.norm() - 1e-9) << from.transpose();
    }
  EXPECT_TRUE(first_served);
}

TEST(Stops, StandOutOfTheWayOfWhatOpens) {
  const mapping::OccupancyMap map = mapped(room_with_screen());
  for (const BasePose& stop : planner_for(map).plan({front_at(1.0)})) {
    const double beside = std::max(0.0, std::abs(stop.pose.y - 1.0) - 0.25),
                 before = std::max(0.0, 2.4 - stop.pose.x - 0.3);
    EXPECT_GE(std::hypot(beside, before), PlannerOptions().robot_radius_m);
  }
}

TEST(Stops, NoneForAFrontWithoutFixtureOrBehindAWall) {
  const mapping::OccupancyMap map = mapped(room_with_screen());
  mapping::Front bare = front_at(1.0), behind = front_at(1.0);
  bare.fixture.reset();
  behind.centre = behind.fixture->centre = {4, 1.0, 1.6};  // In the next room.
  EXPECT_TRUE(planner_for(map).plan({bare, behind}).empty());
}

TEST(Stops, GoElsewhereWhereTheRobotCouldNotStand) {
  const mapping::OccupancyMap map = mapped(room_with_screen());
  BasePosePlanner planner = planner_for(map);
  const std::vector<BasePose> before = planner.plan({front_at(1.0)});
  ASSERT_EQ(before.size(), 1U);
  planner.avoid(before[0].pose);
  const std::vector<BasePose> after = planner.plan({front_at(1.0)});
  ASSERT_EQ(after.size(), 1U);
  EXPECT_GE(std::hypot(after[0].pose.x - before[0].pose.x, after[0].pose.y - before[0].pose.y),
            PlannerOptions().robot_radius_m);
}

}  // namespace
}  // namespace loci::nbv
