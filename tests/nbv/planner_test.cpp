#include "nbv/planner.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nbv/images.h"
#include "tests/mapping/occupancy/box_room.h"

namespace loci::nbv {
namespace {

Isometry3d scanner_at(const mapping::PlanarPose& pose) {
  Isometry3d scanner = map_from_base(pose);
  scanner.translation().z() = mapping::LaserModel().height_m;
  return scanner;
}

/// A long room with a cupboard that hides its east end from the west.
mapping::BoxRoom divided_room() {
  mapping::BoxRoom room;
  room.room = {Vector3d(-3, -2, 0), Vector3d(4, 2, 2.5)};
  room.furniture = {{Vector3d(0.5, -2, 0), Vector3d(0.9, 0.6, 2.2)}};
  return room;
}

mapping::Scan scan_from(const mapping::BoxRoom& room, const mapping::PlanarPose& pose) {
  return room.sweep(scanner_at(pose), 360, 190, 10, 0.005, 3, 180);
}

mapping::OccupancyMap map_of(const mapping::BoxRoom& room, const std::vector<mapping::PlanarPose>& poses) {
  mapping::OccupancyMap map({0.05, 5, 2});
  for (const mapping::PlanarPose& pose : poses) map.insert(scan_from(room, pose));
  return map;
}

const mapping::PlanarPose kStart{-2, -0.5, 0};

TEST(FloorGrid, TellsFloorObstaclesAndTheUnseenApart) {
  mapping::BoxRoom room = divided_room();
  room.furniture.push_back({Vector3d(-1, -1.5, 0.7), Vector3d(-0.2, -1, 0.75)});  // A table top.
  const mapping::FloorGrid floor = floor_grid(map_of(room, {kStart}).voxels(), 0.1, 1.35);
  const auto at = [&](double x, double y) {
    const Eigen::Vector2i cell = floor.cell_of({x, y});
    return floor.index(cell.x(), cell.y());
  };
  EXPECT_TRUE(floor.seen[at(-0.5, 0.5)]);
  EXPECT_FALSE(floor.obstacle[at(-0.5, 0.5)]);
  EXPECT_TRUE(floor.obstacle[at(-0.55, -1.25)]);
  EXPECT_TRUE(floor.obstacle[at(0.5, -1)]);
  EXPECT_FALSE(floor.seen[at(2.5, -1)]);  // Behind the cupboard.
  EXPECT_FALSE(floor.seen[at(-2.2, 0)]);  // Below and behind the scanner.
}

TEST(FloorGrid, FloorUnderSpaceThatWasNotSeenIsNoPlaceToStand) {
  mapping::Voxels voxels;  // The floor is seen everywhere; over its east half only what is below 40 cm.
  voxels.resolution = 0.05;
  voxels.size = {80, 40, 40};
  voxels.states.assign(80 * 40 * 40, mapping::Occupancy::free);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 80; ++x) {
      voxels.states[voxels.index({x, y, 0})] = mapping::Occupancy::occupied;
      for (int z = 8; x >= 40 && z < 40; ++z)
        voxels.states[voxels.index({x, y, z})] = mapping::Occupancy::unknown;
    }
  const mapping::PlanarPose robot{1, 1, 0};
  const mapping::FloorGrid floor = drivable_floor(voxels, robot, mapping::LaserModel(), {});
  const Reachability reach = reachability(floor, robot, {});
  EXPECT_TRUE(reach.stands(floor, floor.index(15, 10)));
  EXPECT_TRUE(floor.seen[floor.index(30, 10)]);
  EXPECT_FALSE(floor.obstacle[floor.index(30, 10)]);
  EXPECT_FALSE(reach.stands(floor, floor.index(30, 10)));
  // What hangs as low as the robot is high is in its way wherever its radius reaches.
  for (int x = 19; x <= 21; ++x) voxels.states[voxels.index({x, 30, 25})] = mapping::Occupancy::occupied;
  const mapping::FloorGrid below = drivable_floor(voxels, robot, mapping::LaserModel(), {});
  const Reachability around = reachability(below, robot, {});
  EXPECT_FALSE(around.stands(below, below.index(10, 15)));
  EXPECT_FALSE(around.stands(below, below.index(12, 15)));
  EXPECT_TRUE(around.stands(below, below.index(15, 15)));
}

TEST(FloorGrid, AFalsePointIsNoObstacleAThinPoleIs) {
  mapping::Voxels voxels;  // Free space over a floor.
  voxels.resolution = 0.05;
  voxels.size = {60, 40, 30};
  voxels.states.assign(60 * 40 * 30, mapping::Occupancy::free);
  const auto occupy = [&](int x, int y, int z) {
    const size_t voxel = voxels.index({x, y, z});
    voxels.states[voxel] = mapping::Occupancy::occupied;
    return voxel;
  };
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) occupy(x, y, 0);
  occupy(10, 10, 2);  // Right over the floor: the floor's voxels are nothing that it is part of.
  for (int x = 20; x < 24; ++x)
    for (int y = 10; y < 14; ++y) voxels.doubtful.push_back(occupy(x, y, 12));
  for (int z = 2; z < 20; ++z) occupy(40, 30, z);
  const mapping::FloorGrid floor = floor_grid(voxels, 0.1, 1.35);
  const auto obstacle = [&](int x, int y) {
    const Eigen::Vector2i cell = floor.cell_of(voxels.center({x, y, 0}).head<2>());
    return floor.obstacle[floor.index(cell.x(), cell.y())] != 0;
  };
  EXPECT_FALSE(obstacle(10, 10));
  EXPECT_FALSE(obstacle(21, 11));
  EXPECT_TRUE(obstacle(40, 30));
  EXPECT_EQ(std::count(floor.obstacle.begin(), floor.obstacle.end(), 1), 1);
  EXPECT_EQ(std::count(floor.seen.begin(), floor.seen.end(), 0), 0);
}

TEST(Reachability, KeepsTheRobotsRadiusFromObstaclesAndGoesAroundThem) {
  const mapping::OccupancyMap map = map_of(divided_room(), {kStart, {1.5, 1.4, -1.2}, {-0.3, 1.3, 0}});
  const mapping::FloorGrid floor = floor_grid(map.voxels(), 0.1, 1.35);
  const Reachability reach = shortest_paths(floor, kStart, 0.3, 1.2);
  const mapping::PlanarPose goal{2, -1, 0.5};
  const std::vector<mapping::PlanarPose> way = path_to(floor, reach, goal);
  ASSERT_GE(way.size(), 3U);
  EXPECT_EQ(way.back().yaw, goal.yaw);
  double length = 0;
  for (size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector2d from(way[i].x, way[i].y), to(way[i + 1].x, way[i + 1].y);
    length += (to - from).norm();
    for (double t = 0; t <= 1; t += 0.05) {
      const Vector2d p = from + t * (to - from);
      const double dx = std::max({0.5 - p.x(), 0.0, p.x() - 0.9}), dy = std::max(0.0, p.y() - 0.6);
      EXPECT_GT(std::hypot(dx, dy), 0.2);  // Less half a cell's diagonal.
    }
  }
  EXPECT_GT(length, 4.2);  // Straight through the cupboard it would be 4.03 m.
  EXPECT_TRUE(path_to(floor, reach, {7, 7, 0}).empty());
}

TEST(VisibilityKernel, HoldsThePlacesFromWhichTheVoxelIsSeen) {
  const VisibilityKernel kernel(180 * kDegree, 1, 4, 90 * kDegree, 0.1);  // Looking along +y.
  size_t cells = 0;
  for (const auto& run : kernel.runs())
    for (int x = run.x_begin; x < run.x_end; ++x) {
      ++cells;
      EXPECT_LE(run.y, 0);  // Only from places with the voxel in front, at larger y.
      EXPECT_GE(std::hypot(x, run.y), 10 - 1e-9);
      EXPECT_LE(std::hypot(x, run.y), 40 + 1e-9);
    }
  EXPECT_NEAR(static_cast<double>(cells) * 0.01, kPi / 2 * (16 - 1), 0.5);  // Half a ring, m².
}

TEST(Costmaps, AStencilIsTheSumOverAllVoxels) {
  mapping::FloorGrid floor;
  floor.cell = 0.1;
  floor.width = 70;
  floor.height = 50;
  for (auto* layer : {&floor.seen, &floor.obstacle, &floor.open}) layer->assign(3500, 0);
  std::vector<int> votes(3500, 0);
  Random random(4);
  for (int i = 0; i < 30; ++i) votes[random.index(3500)] += 1 + static_cast<int>(random.index(3));
  const VisibilityKernel kernel(120 * kDegree, 0.5, 2, 45 * kDegree, 0.1);
  const CostmapStack stack = vote(floor, votes, {kernel, kernel}, 2);
  for (int trial = 0; trial < 200; ++trial) {
    const int x = static_cast<int>(random.index(70)), y = static_cast<int>(random.index(50));
    int sum = 0;
    for (int vy = 0; vy < 50; ++vy)
      for (int vx = 0; vx < 70; ++vx) {
        const double distance = 0.1 * std::hypot(vx - x, vy - y);
        const double off = std::remainder(std::atan2(vy - y, vx - x) - 45 * kDegree, 2 * kPi);
        if (distance >= 0.5 && distance <= 2 && std::abs(off) <= 60 * kDegree + 1e-9)
          sum += votes[floor.index(vx, vy)];
      }
    ASSERT_EQ(stack.layers[1][floor.index(x, y)], static_cast<float>(sum));
  }
}

TEST(ViewCaster, AllAroundCountsTheAreaOfTheWallsOfARoom) {
  mapping::Voxels voxels;  // A closed box of 4 × 4 × 2.5 m, its walls one voxel thick.
  voxels.resolution = 0.05;
  voxels.size = {80, 80, 50};
  voxels.states.assign(80 * 80 * 50, mapping::Occupancy::free);
  ViewVoxels view;
  view.states.assign(voxels.states.size(), ViewVoxel::free);
  for (int z = 0; z < 50; ++z)
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 80; ++x)
        if (std::min({x, y, z, 79 - x, 79 - y, 49 - z}) == 0)
          view.states[voxels.index({x, y, z})] = x == 79 ? ViewVoxel::unknown : ViewVoxel::occupied;
        else if (x == 78)
          view.states[voxels.index({x, y, z})] = ViewVoxel::frontier;
  const ViewCaster caster(voxels, view, mapping::LaserModel(), 10, 2);
  const ViewCounts east = caster.view({2, 2, 0}), west = caster.view({2, 2, kPi});
  EXPECT_GT(east.frontier, 3);
  EXPECT_LT(west.frontier, 0.5);
  const std::vector<ViewCounts> panorama = caster.panorama({2, 2});
  EXPECT_DOUBLE_EQ(caster.part(panorama, 0).frontier, east.frontier);
  EXPECT_DOUBLE_EQ(caster.part(panorama, kPi).occupied, west.occupied);
  const ViewCaster finer(voxels, view, mapping::LaserModel(), 10, 1);
  EXPECT_NEAR(finer.view({2, 2, 0}).frontier, east.frontier,
              0.1 * east.frontier);  // An area, not a number of rays.
}

TEST(NextView, LooksAroundTheCornerAndSaysWhy) {
  const mapping::BoxRoom room = divided_room();
  const mapping::OccupancyMap map = map_of(room, {kStart});
  const NextView view = next_view(map, kStart, mapping::LaserModel(), {}, Random(1));
  ASSERT_TRUE(view.pose) << view.reason;
  EXPECT_GT(view.expected_gain, 1);
  EXPECT_GT(view.expected_overlap, 0.1);
  EXPECT_FALSE(view.reason.empty());
  ASSERT_FALSE(view.path.empty());
  EXPECT_EQ(view.path.back().x, view.pose->x);
  // The scan there shows what was hidden.
  mapping::OccupancyMap after = map_of(room, {kStart});
  after.insert(scan_from(room, *view.pose));
  const auto known = [](const mapping::OccupancyMap& m) {
    const mapping::Voxels voxels = m.voxels();
    return std::count(voxels.states.begin(), voxels.states.end(), mapping::Occupancy::occupied);
  };
  EXPECT_GT(known(after), 1.15 * static_cast<double>(known(map)));
}

TEST(NextView, IsTheSameOnAnyNumberOfThreads) {
  const mapping::OccupancyMap map = map_of(divided_room(), {kStart});
  PlannerOptions options;
  options.threads = 1;
  const NextView one = next_view(map, kStart, mapping::LaserModel(), options, Random(9));
  options.threads = 3;
  const NextView three = next_view(map, kStart, mapping::LaserModel(), options, Random(9));
  EXPECT_EQ(one.details["samples"], three.details["samples"]);
  EXPECT_EQ(one.reason, three.reason);
}

TEST(NextView, StopsInTheEndWithItsReason) {
  const mapping::BoxRoom room = divided_room();
  mapping::OccupancyMap map = map_of(room, {kStart});
  mapping::PlanarPose robot = kStart;
  int scans = 1;
  NextView view;
  for (; scans < 20; ++scans) {
    view = next_view(map, robot, mapping::LaserModel(), {}, Random(static_cast<uint64_t>(scans)));
    if (!view.pose) break;
    robot = *view.pose;
    map.insert(scan_from(room, robot));
  }
  EXPECT_FALSE(view.pose);
  EXPECT_LT(scans, 14);
  EXPECT_NE(view.reason.find("no reachable view"), std::string::npos) << view.reason;
  EXPECT_TRUE(map.at({3.97, -1.5, 1.0}) == mapping::Occupancy::occupied ||
              map.at({4.02, -1.5, 1.0}) ==
                  mapping::Occupancy::occupied);  // The hidden end's wall, give or take noise.
}

TEST(NextView, ChoosesNoViewThatSharesTooLittleWithWhatIsKnown) {
  const mapping::OccupancyMap map = map_of(divided_room(), {kStart});
  PlannerOptions options;
  options.gain_weight = 1;
  const NextView greedy = next_view(map, kStart, mapping::LaserModel(), options, Random(2));
  ASSERT_TRUE(greedy.pose);
  options.min_view_overlap = greedy.expected_overlap + 0.1;
  const NextView careful = next_view(map, kStart, mapping::LaserModel(), options, Random(2));
  ASSERT_TRUE(careful.pose) << careful.reason;
  EXPECT_GE(careful.expected_overlap, options.min_view_overlap);
}

TEST(NextView, TheScannerIsRaisedToSeeWhatIsBehindAnObstacle) {
  mapping::BoxRoom room = divided_room();
  room.furniture = {{Vector3d(0.5, -2, 0), Vector3d(0.9, 2, 1.35)}};
  const mapping::OccupancyMap map = map_of(room, {kStart});
  PlannerOptions options;
  const NextView carried = next_view(map, kStart, mapping::LaserModel(), options, Random(2));
  options.heights = {1.25, 0.9, 1.7};
  const NextView raised = next_view(map, kStart, mapping::LaserModel(), options, Random(2));
  ASSERT_TRUE(carried.pose) << carried.reason;
  ASSERT_TRUE(raised.pose) << raised.reason;
  EXPECT_FALSE(carried.height_m);
  EXPECT_EQ(raised.height_m, 1.7) << raised.reason;
  EXPECT_GT(raised.expected_gain, carried.expected_gain);
  EXPECT_FALSE(raised.path.empty());
}

TEST(NextView, WeightTurnsFromOverlapToGain) {
  const mapping::OccupancyMap map = map_of(divided_room(), {kStart});
  PlannerOptions options;
  std::vector<NextView> views;
  for (const double weight : {0.0, 0.5, 1.0}) {
    options.gain_weight = weight;
    views.push_back(next_view(map, kStart, mapping::LaserModel(), options, Random(2)));
    ASSERT_TRUE(views.back().pose);
  }
  EXPECT_GE(views[0].expected_overlap, views[1].expected_overlap);
  EXPECT_GE(views[2].expected_gain, views[1].expected_gain);
  EXPECT_GT(views[2].expected_gain, views[0].expected_gain);
}

TEST(NextView, ChoosesFromAPoolWhatShowsMost) {
  const mapping::OccupancyMap map = map_of(divided_room(), {kStart});
  const std::vector<mapping::PlanarPose> pool = {{-2, 0.5, 0}, {1.6, 1.3, -1.0}, {-1.8, -0.5, 0}};
  PlannerOptions options;
  options.gain_weight = 1;
  const PoolChoice choice = choose_view(map, pool, mapping::LaserModel(), options);
  ASSERT_TRUE(choice.index) << choice.view.reason;
  EXPECT_EQ(*choice.index, 1U);  // Behind the cupboard.
  options.min_gain = 50;
  EXPECT_FALSE(choose_view(map, pool, mapping::LaserModel(), options).index);
  EXPECT_FALSE(choose_view(map, {}, mapping::LaserModel(), options).index);
}

TEST(ViewImages, ShowFrontierCostsOfEachOrientationAndTheChoice) {
  const mapping::OccupancyMap map = map_of(divided_room(), {kStart});
  const ViewPlan plan = plan_view(map, kStart, mapping::LaserModel(), {}, Random(1));
  const std::vector<ViewImage> images = view_images(plan, kStart);
  EXPECT_EQ(images.size(), 4U + 8 + 1);
  for (const ViewImage& image : images) {
    EXPECT_EQ(image.image.size(), images[0].image.size());
    cv::Scalar mean, deviation;
    cv::meanStdDev(image.image, mean, deviation);
    EXPECT_GT(deviation[1], 1) << image.name;  // Not blank.
  }
  EXPECT_TRUE(
      view_images(plan_view(mapping::OccupancyMap({0.05, 5, 1}), {}, mapping::LaserModel(), {}, Random(1)),
                  {})
          .empty());
}

TEST(NextView, SaysThatNothingIsKnownOrNothingCanBeReached) {
  const mapping::OccupancyMap empty({0.05, 5, 1});
  NextView view = next_view(empty, {}, mapping::LaserModel(), {}, Random(1));
  EXPECT_FALSE(view.pose);
  EXPECT_NE(view.reason.find("nothing is known"), std::string::npos);
  view = next_view(map_of(divided_room(), {kStart}), {30, 30, 0}, mapping::LaserModel(), {}, Random(1));
  EXPECT_FALSE(view.pose);
  EXPECT_NE(view.reason.find("no pose can be reached"), std::string::npos);
}

}  // namespace
}  // namespace loci::nbv
