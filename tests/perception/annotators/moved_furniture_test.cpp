#include "perception/annotators/structure/moved_furniture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/simulation/scenario.h"
#include "mapping/world/free_standing.h"
#include "mapping/world/urdf.h"
#include "perception/annotators/structure/normals.h"

namespace loci::perception {
namespace {

const mapping::PinholeCamera kFurnitureCamera{320, 240, 290, 290, 160, 120};

std::string cuboid(const std::string& size, const std::string& xyz) {
  return "<visual><origin xyz=\"" + xyz + "\"/><geometry><box size=\"" + size + "\"/></geometry></visual>";
}

std::string link(const std::string& name, const std::string& xyz, const std::string& visuals) {
  return "<link name=\"" + name + "\">" + visuals + "</link><joint name=\"" + name +
         "_joint\" type=\"fixed\"><parent link=\"map\"/><child link=\"" + name + "\"/><origin xyz=\"" + xyz +
         "\"/></joint>";
}

/// Two walls, a counter along one of them, a table, a chair beside it, and an island of a top and a cabinet
/// with a drawer.
mapping::World kitchen_with_table() {
  const std::string table = cuboid("1.2 0.8 0.03", "0 0 0.735") + cuboid("0.06 0.06 0.72", "0.55 0.35 0.36") +
                            cuboid("0.06 0.06 0.72", "-0.55 0.35 0.36") +
                            cuboid("0.06 0.06 0.72", "0.55 -0.35 0.36") +
                            cuboid("0.06 0.06 0.72", "-0.55 -0.35 0.36");
  const std::string chair = cuboid("0.42 0.42 0.03", "0 0 0.45") + cuboid("0.42 0.03 0.5", "0 0.2 0.7") +
                            cuboid("0.04 0.04 0.44", "0.18 0.18 0.22") +
                            cuboid("0.04 0.04 0.44", "-0.18 0.18 0.22");
  return mapping::parse_urdf(
      "<robot name=\"kitchen\"><link name=\"map\"/>" +
          link("floor", "0 0 -0.01", cuboid("8 8 0.02", "0 0 0")) +
          link("wall_north", "0 2.05 1.25", cuboid("8 0.1 2.5", "0 0 0")) +
          link("wall_east", "3.05 0 1.25", cuboid("0.1 8 2.5", "0 0 0")) +
          link("counter_1", "0 1.7 0", cuboid("2.4 0.6 0.9", "0 0 0.45")) +
          link("table_1", "0 -0.4 0", table) + link("chair_1", "0 -1.4 0", chair) +
          link("island_1", "2 -0.5 0", cuboid("1 0.7 0.04", "0 0 0.88")) +
          link("cabinet_1", "2 -0.5 0", cuboid("0.9 0.6 0.86", "0 0 0.43")) + "<link name=\"drawer\">" +
          cuboid("0.5 0.02 0.2", "0 0 0") +
          "</link><joint name=\"drawer_joint\" type=\"prismatic\"><parent link=\"cabinet_1\"/>"
          "<child link=\"drawer\"/><origin xyz=\"0 -0.32 0.6\"/><axis xyz=\"0 -1 0\"/>"
          "<limit lower=\"0\" upper=\"0.4\" effort=\"1\" velocity=\"1\"/></joint></robot>",
      "test.urdf");
}

Isometry3d motion(const Vector3d& middle, double x, double y, double degrees) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(degrees * kDegree, Vector3d::UnitZ()).toRotationMatrix();
  motion.translation() = middle + Vector3d(x, y, 0) - motion.linear() * middle;
  return motion;
}

std::shared_ptr<KnownMap> map_of(mapping::World world) {
  Warnings warnings;
  return KnownMap::make(std::move(world), {}, {}, warnings);
}

const Vector3d kTable(0, -0.4, 0.375);
/// The table before the counter.
const Isometry3d kView = mapping::looking_at({0.2, -2.2, 1.7}, {0.1, 0, 0.6});

/// A room in which things may have been changed, seen by a camera, against the map.
class MovedFurnitureTest : public ::testing::Test {
 protected:
  std::shared_ptr<KnownMap> map_ = map_of(kitchen_with_table());
  MovedFurniture furniture_{*map_, PoseRefinementOptions()};

  size_t number(const std::string& name) const {
    return static_cast<size_t>(std::ranges::find(furniture_.pieces(), name, &Furniture::name) -
                               furniture_.pieces().begin());
  }
  const FurnitureState& state(const std::string& name) const { return furniture_.states()[number(name)]; }

  bool look(const mapping::RenderScene& room, const Isometry3d& camera, const Isometry3d& believed) {
    const cv::Mat depth = room.render(kFurnitureCamera, camera).depth;
    const cv::Mat points = points_from_depth(depth, kFurnitureCamera),
                  normals = normals_from_depth(depth, kFurnitureCamera);
    const JointState joints;
    return furniture_.update({points, normals, kFurnitureCamera, believed, joints}, 1);
  }
  bool look(const mapping::RenderScene& room, const Isometry3d& camera = kView) {
    return look(room, camera, camera);
  }

  static mapping::RenderScene room(const std::vector<MovedBranch>& moved = {}) {
    mapping::RenderScene scene;
    Warnings warnings;
    scene.add(with_moved(kitchen_with_table(), moved), {}, Isometry3d::Identity(), warnings);
    return scene;
  }

  void expect_nothing_moved() const {
    for (const FurnitureState& one : furniture_.states()) EXPECT_FALSE(one.moved) << one.name;
    EXPECT_TRUE(furniture_.texts().empty());
  }
};

TEST_F(MovedFurnitureTest, MovableIsWhatStandsFree) {
  std::vector<std::string> names;
  for (const Furniture& piece : furniture_.pieces()) names.push_back(piece.name);
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"chair_1", "island_1", "table_1"}));
  std::vector<std::string> island = furniture_.pieces()[number("island_1")].links;
  std::ranges::sort(island);
  EXPECT_EQ(island, (std::vector<std::string>{"cabinet_1", "drawer", "island_1"}));
  EXPECT_NEAR(furniture_.pieces()[number("table_1")].top, 0.75, 0.01);
}

TEST_F(MovedFurnitureTest, WhereTheMapIsRightNothingIsSaid) {
  for (const Vector3d& from : {Vector3d(0.2, -2.2, 1.7), {-2, -0.5, 1.6}, {1.2, 0.8, 1.5}, {1, -3, 1.5}})
    EXPECT_FALSE(look(room(), mapping::looking_at(from, {0.3, -0.3, 0.5})));
  expect_nothing_moved();
  for (const FurnitureState& one : furniture_.states())
    EXPECT_EQ(one.log_odds, mapping::kFurnitureMotion.prior_log_odds) << one.name;
}

TEST_F(MovedFurnitureTest, ATableIsFoundWhereItStands) {
  const std::vector<FurnitureState> unmoved = furniture_.states();
  for (const auto& [x, y, degrees] :
       {std::array{0.44, 0.13, 12.0}, {-0.7, 0.3, -35}, {0.1, 0, 0}, {0, -0.12, 4}, {0.3, 0.2, 90}}) {
    furniture_.restore(unmoved);
    const Isometry3d truth = motion(kTable, x, y, degrees);
    EXPECT_TRUE(look(room({{"table_1", truth}}))) << x;
    ASSERT_TRUE(state("table_1").moved) << x;
    EXPECT_TRUE(state("table_1").found);
    const Isometry3d found = furniture_.motion(number("table_1"));
    EXPECT_LT((found * kTable - truth * kTable).norm(), 0.03)
        << x << ": " << state("table_1").shift.transpose();
    EXPECT_LT(Eigen::AngleAxisd(found.linear().transpose() * truth.linear()).angle() / kDegree, 3) << x;
    EXPECT_FALSE(state("chair_1").moved);
    // The map has it there from now on: the same frame shows nothing new.
    EXPECT_FALSE(look(room({{"table_1", truth}})));
  }
}

TEST_F(MovedFurnitureTest, TheSceneOfTheMapFollowsAndIsReset) {
  const size_t table = static_cast<size_t>(std::ranges::find(map_->scene.link_names(), "table_1") -
                                           map_->scene.link_names().begin());
  look(room({{"table_1", motion(kTable, 0.44, 0.13, 12)}}));
  EXPECT_NEAR(map_->scene.map_from_link(table).translation().x(), 0.44, 0.03);
  EXPECT_EQ(furniture_.texts().size(), 1U);
  EXPECT_EQ(furniture_.texts()[0].substr(0, 48), "table_1 is not where the map has it: it moved by");
  furniture_.reset();
  EXPECT_EQ(map_->scene.map_from_link(table).translation().x(), 0);
}

TEST_F(MovedFurnitureTest, TheIslandMovesWithItsCabinetAndDrawer) {
  const Vector3d middle(2, -0.5, 0.45);
  const Isometry3d truth = motion(middle, -0.2, -0.3, 20),
                   camera = mapping::looking_at({1.2, -2.4, 1.7}, {2, -0.5, 0.7});
  EXPECT_TRUE(look(room({{"island_1", truth}, {"cabinet_1", truth}}), camera));
  ASSERT_TRUE(state("island_1").found && state("island_1").moved);
  EXPECT_LT((furniture_.motion(number("island_1")) * middle - truth * middle).norm(), 0.03);
  EXPECT_NE(map_->world.parent_joint("cabinet_1")->parent_from_joint.translation().x(), 2);
}

TEST_F(MovedFurnitureTest, AnEdgeSeenInPartShowsNoMotionAlongItself) {
  // The middle of the table's long side, which moved towards the camera.
  const Isometry3d truth = motion(kTable, 0, -0.1, 0),
                   camera = mapping::looking_at({0, -1.7, 1.3}, {0, -0.8, 0.7});
  for (int i = 0; i < 3; ++i) look(room({{"table_1", truth}}), camera);
  EXPECT_LT(std::abs(state("table_1").shift.x()), 0.02) << state("table_1").shift.transpose();
}

TEST(MovableFurniture, ACounterIsBuiltInAlthoughTheMapLacksTheWallBehindIt) {
  mapping::World world = kitchen_with_table();
  std::erase_if(world.links, [](const mapping::Link& one) { return one.name == "wall_north"; });
  std::erase_if(world.joints, [](const mapping::Joint& one) { return one.child == "wall_north"; });
  const std::vector<Furniture> pieces = movable_furniture(*map_of(std::move(world)));
  EXPECT_TRUE(std::ranges::none_of(pieces, [](const Furniture& piece) { return piece.name == "counter_1"; }));
  EXPECT_TRUE(std::ranges::any_of(pieces, [](const Furniture& piece) { return piece.name == "table_1"; }));
}

TEST_F(MovedFurnitureTest, WhatStandsBeforeItIsNoEvidence) {
  mapping::RenderScene scene = room();
  Warnings warnings;
  scene.add("person", triangulate(mapping::Box{Vector3d(0.5, 0.3, 1.7)}, {}, warnings),
            Isometry3d(Eigen::Translation3d(0.1, -1.2, 0.85)));
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(look(scene));
  expect_nothing_moved();
}

TEST_F(MovedFurnitureTest, AnErrorOfTheCameraIsNoMotion) {
  for (const Vector3d& error : {Vector3d(0.08, 0, 0), {0, 0.08, 0}, {-0.06, 0.06, 0}}) {
    Isometry3d believed = kView;
    believed.translation() += error;
    for (int i = 0; i < 3; ++i) look(room(), kView, believed);
    expect_nothing_moved();
  }
}

TEST_F(MovedFurnitureTest, ATableThatIsNowhereInViewIsLostUntilItIsSeen) {
  const Isometry3d truth = motion(kTable, -2.2, 0.6, 30);
  EXPECT_TRUE(look(room({{"table_1", truth}})));
  EXPECT_TRUE(state("table_1").moved);
  EXPECT_FALSE(state("table_1").found);
  EXPECT_NE(furniture_.texts()[0].find("not observed"), std::string::npos);
  EXPECT_TRUE(look(room({{"table_1", truth}}), mapping::looking_at({-0.6, -1.6, 1.7}, {-2.2, 0.2, 0.6})));
  EXPECT_TRUE(state("table_1").found);
  const Isometry3d found = furniture_.motion(number("table_1"));
  EXPECT_LT((found * kTable - truth * kTable).norm(), 0.03);
  // And back.
  EXPECT_TRUE(look(room(), mapping::looking_at({-0.6, -1.6, 1.7}, {-2.2, 0.2, 0.6})));
  look(room());
  expect_nothing_moved();
}

TEST_F(MovedFurnitureTest, ALaterRunGoesOn) {
  const mapping::RenderScene scene = room({{"table_1", motion(kTable, 0.44, 0.13, 12)}});
  look(scene);
  const std::vector<FurnitureState> known = furniture_.states();
  furniture_.reset();
  MovedFurniture later(*map_, PoseRefinementOptions());
  later.restore(known);
  EXPECT_EQ(later.states()[number("table_1")].shift, known[number("table_1")].shift);
  EXPECT_GT(std::abs(map_->world.parent_joint("table_1")->parent_from_joint.translation().x()), 0.4);
}

}  // namespace
}  // namespace loci::perception
