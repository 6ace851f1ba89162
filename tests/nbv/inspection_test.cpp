#include "nbv/inspection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "nbv/exploration.h"
#include "tests/mapping/occupancy/box_room.h"

namespace loci::nbv {
namespace {

/// A cupboard stands along the east wall, 90 cm high.
mapping::BoxRoom furnished_room() {
  mapping::BoxRoom room;
  room.room = {Vector3d(-4, -2, 0), Vector3d(3, 2, 2.8)};
  room.furniture = {{Vector3d(2.4, -1.5, 0), Vector3d(3, 1.5, 0.9)}};
  return room;
}

mapping::LaserModel coarse_laser() {
  mapping::LaserModel laser;
  laser.azimuth_step_deg = laser.tilt_step_deg = 0.5;
  laser.azimuth_range_deg = 360;
  laser.tilt_min_deg = -60;
  laser.tilt_max_deg = 60;
  return laser;
}

mapping::ScanSet scans_from(const mapping::BoxRoom& room, const std::vector<mapping::PlanarPose>& poses) {
  mapping::ScanSet set;
  for (const mapping::PlanarPose& pose : poses) {
    Isometry3d scanner = map_from_base(pose);
    scanner.translation().z() = mapping::LaserModel().height_m;
    set.scans.push_back(room.sweep(scanner, 720, 240, 10, 0.005, 3, 60));
  }
  return set;
}

NextView inspect(const mapping::ScanSet& scans, const std::vector<double>& heights = {},
                 const mapping::PlanarPose& robot = {-2, 0, 0}) {
  mapping::OccupancyMap map({0.05, 7, 2});
  for (const mapping::Scan& scan : scans.scans) map.insert(scan);
  InspectionOptions options;
  options.points_per_cm2 = 0.25;  // As with the laser's own steps, four times the points.
  options.heights = heights;
  return inspection_view({scans.scans.begin(), scans.scans.end()}, map, robot, coarse_laser(), {}, options);
}

TEST(Inspection, FurnitureSeenFromAfarIsLookedAtFromNear) {
  const NextView view = inspect(scans_from(furnished_room(), {{-2, 0, 0}, {-1, 1, 0}}));
  ASSERT_TRUE(view.pose) << view.reason;
  EXPECT_GT(view.expected_gain, 0.5);
  EXPECT_GT(view.pose->x, -0.2);  // At most 2.5 m from the cupboard's face at x = 2.4 …
  EXPECT_LT(view.pose->x, 2.1);   // … and not in it.
  EXPECT_FALSE(view.path.empty());
}

TEST(Inspection, FurnitureSeenFromNearNeedsNoOtherView) {
  const NextView view = inspect(scans_from(furnished_room(), {{0.9, -0.7, 0}, {0.9, 0.7, 0}, {-2, 0, 0}}));
  EXPECT_FALSE(view.pose) << view.reason;
  EXPECT_FALSE(view.reason.empty());
}

TEST(Inspection, InANarrowAisleFurnitureIsLookedAtFromALoweredScanner) {
  mapping::BoxRoom aisle = furnished_room();
  aisle.room = {Vector3d(1.3, -4, 0), Vector3d(3, 4, 2.8)};  // Leaves 1.1 m before the cupboard.
  const mapping::ScanSet scans = scans_from(aisle, {{1.85, -3.2, kPi / 2}, {1.85, 3.2, -kPi / 2}});
  const mapping::PlanarPose robot{1.85, -3.2, kPi / 2};
  const NextView carried = inspect(scans, {}, robot);
  const NextView lowered = inspect(scans, {1.25, 0.8}, robot);
  ASSERT_TRUE(lowered.pose) << lowered.reason;
  EXPECT_EQ(lowered.height_m, 0.8);
  EXPECT_GT(lowered.expected_gain, 1.2 * carried.expected_gain);
}

TEST(Inspection, TheTopOfAWallShelfIsLookedAtFromARaisedScanner) {
  mapping::BoxRoom room = furnished_room();
  room.furniture.push_back({Vector3d(2.75, -0.6, 1.40), Vector3d(3, 0.6, 1.44)});
  const mapping::ScanSet scans = scans_from(room, {{0.9, -0.7, 0}, {0.9, 0.7, 0}, {-2, 0, 0}});
  EXPECT_FALSE(inspect(scans, {1.25}).pose);  // From below nothing shows the top.
  const NextView raised = inspect(scans, {1.25, 0.9, 1.7});
  ASSERT_TRUE(raised.pose) << raised.reason;
  EXPECT_EQ(raised.height_m, 1.7);
}

TEST(Inspection, HeightsOfAScannerAreARangeAroundWhereItIsCarried) {
  EXPECT_EQ(scanner_heights("", 1.25), std::vector{1.25});
  EXPECT_EQ(scanner_heights("0.9..1.6", 1.25), (std::vector{1.25, 0.9, 1.6}));
  EXPECT_EQ(scanner_heights("1.25..1.6", 1.25), (std::vector{1.25, 1.6}));
  for (const char* wrong : {"1.3..1.6", "0.9", "0.9..", "0.9..1.6 m", "0.9..1.2", "-1..2", "1.25..nan"})
    EXPECT_THROW(scanner_heights(wrong, 1.25), Error) << wrong;
}

TEST(Inspection, BareWallsAreNotLookedAt) {
  mapping::BoxRoom room = furnished_room();
  room.furniture.clear();
  EXPECT_FALSE(inspect(scans_from(room, {{-2, 0, 0}, {-1, 1, 0}})).pose);
}

}  // namespace
}  // namespace loci::nbv
