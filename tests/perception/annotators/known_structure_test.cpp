#include "perception/annotators/structure/known_structure.h"
#include "mapping/base/math/math.h"
#include "mapping/base/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "mapping/world/urdf.h"
#include "perception/annotators/structure/articulated_fronts.h"
#include "perception/annotators/structure/normals.h"
#include "perception/annotators/structure/pose_refinement.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
namespace {

const mapping::PinholeCamera kCamera{320, 240, 290, 290, 160, 120};

mapping::World world_of(const std::string& parts) {
  return mapping::parse_urdf("<robot name=\"kitchen\">" + parts + "</robot>", "test.urdf");
}

std::string box(const std::string& name, const std::string& size) {
  return "<link name=\"" + name + "\"><visual><geometry><box size=\"" + size +
         "\"/></geometry></visual></link>";
}

std::string fixed(const std::string& child, const std::string& xyz) {
  return "<joint name=\"" + child + "_joint\" type=\"fixed\"><parent link=\"map\"/><child link=\"" + child +
         "\"/><origin xyz=\"" + xyz + "\"/></joint>";
}

/// A floor, two walls, and a cabinet with a drawer and a door in front of one of them.
mapping::World kitchen() {
  return world_of(
      "<link name=\"map\"/>" + box("floor", "6 6 0.02") + fixed("floor", "0 0 -0.01") +
      box("wall_north", "6 0.1 3") + fixed("wall_north", "0 1.5 1.5") + box("wall_east", "0.1 6 3") +
      fixed("wall_east", "1.6 0 1.5") + box("counter", "1.6 0.6 0.85") + fixed("counter", "0 1.1 0.425") +
      box("drawer", "0.6 0.02 0.3") +
      "<joint name=\"drawer_joint\" type=\"prismatic\"><parent link=\"map\"/><child link=\"drawer\"/>"
      "<origin xyz=\"-0.4 0.78 0.6\"/><axis xyz=\"0 -1 0\"/>"
      "<limit lower=\"0\" upper=\"0.45\" effort=\"1\" velocity=\"1\"/></joint>"
      "<link name=\"door\"><visual><origin xyz=\"0.25 0 0\"/><geometry><box size=\"0.5 0.02 0.6\"/>"
      "</geometry></visual></link>"
      "<joint name=\"door_joint\" type=\"revolute\"><parent link=\"map\"/><child link=\"door\"/>"
      "<origin xyz=\"0.1 0.78 0.45\"/><axis xyz=\"0 0 -1\"/>"
      "<limit lower=\"0\" upper=\"1.8\" effort=\"1\" velocity=\"1\"/></joint>");
}

Isometry3d looking(const Vector3d& from, const Vector3d& at) {
  Isometry3d pose = Isometry3d::Identity();
  const Vector3d z = (at - from).normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = from;
  return pose;
}

mapping::RenderScene scene_of(const mapping::World& world, const JointState& joints = {}) {
  mapping::RenderScene scene;
  Warnings warnings;
  scene.add(world, {}, Isometry3d::Identity(), warnings);
  scene.set_joints(0, joints);
  return scene;
}

mapping::TriangleMesh cube(double side) {
  Warnings warnings;
  return triangulate(mapping::Box{Vector3d(side, side, side)}, {}, warnings);
}

struct Image {
  cv::Mat points, normals;
};

Image image_of(const mapping::RenderScene& scene, const Isometry3d& map_from_camera) {
  const cv::Mat depth = scene.render(kCamera, map_from_camera).depth;
  return {points_from_depth(depth, kCamera), normals_from_depth(depth, kCamera)};
}

double degrees(const Isometry3d& a, const Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / kPi;
}

Isometry3d at(const Vector3d& position) {
  return Isometry3d(Eigen::Translation3d(position));
}

TEST(PoseRefinement, FindsTheCameraThoughThingsStandAround) {
  const Isometry3d truth = looking({-0.5, -0.8, 1.5}, {0.5, 1.2, 0.8});
  mapping::RenderScene seen = scene_of(kitchen());
  for (int i = 0; i < 5; ++i) seen.add("thing", cube(0.2), at({-0.6 + 0.3 * i, 1.0, 0.95}));
  const Image image = image_of(seen, truth);
  const mapping::RenderScene map = scene_of(kitchen());
  for (const double cm : {2.0, 5.0}) {
    Isometry3d given = truth;
    given.translation() += 0.01 * cm * Vector3d(0.6, -0.64, 0.48);
    given.rotate(Eigen::AngleAxisd(0.4 * cm * kPi / 180, Vector3d(0.6, 0.64, -0.48)));
    const PoseRefinement found =
        refine_pose(image.points, image.normals, kCamera, given, map, PoseRefinementOptions(), 1);
    EXPECT_TRUE(found.moved) << found.verdict;
    EXPECT_EQ(found.constrained, 6);
    EXPECT_LT((found.map_from_camera.translation() - truth.translation()).norm(), 0.005) << cm;
    EXPECT_LT(degrees(found.map_from_camera, truth), 0.2) << cm;
  }
}

TEST(PoseRefinement, LeavesDirectionsThatASingleWallDoesNotDetermine) {
  const mapping::World wall =
      world_of("<link name=\"map\"/>" + box("wall", "40 0.1 40") + fixed("wall", "0 1.5 0"));
  const mapping::RenderScene map = scene_of(wall);
  const Isometry3d truth = looking({0, 0, 0}, {0.1, 1.5, 0.1});
  const Image image = image_of(map, truth);
  Isometry3d given = truth;
  given.translation() += Vector3d(0.03, 0.05, 0.04);
  const PoseRefinement found =
      refine_pose(image.points, image.normals, kCamera, given, map, PoseRefinementOptions(), 1);
  EXPECT_EQ(found.constrained, 3);
  EXPECT_TRUE(found.moved);
  EXPECT_NE(found.verdict.find("3 of 6"), std::string::npos) << found.verdict;
  const Vector3d left = found.map_from_camera.translation() - truth.translation();
  EXPECT_NEAR(left.y(), 0, 0.003);    // Towards the wall: found.
  EXPECT_NEAR(left.x(), 0.03, 0.01);  // Along it: as given.
  EXPECT_NEAR(left.z(), 0.04, 0.01);
}

TEST(PoseRefinement, KeepsThePoseThatIsRightAndThatOfAnotherPlace) {
  const mapping::RenderScene map = scene_of(kitchen());
  const Isometry3d truth = looking({-0.5, -0.8, 1.5}, {0.5, 1.2, 0.8});
  const Image image = image_of(map, truth);
  const PoseRefinement right =
      refine_pose(image.points, image.normals, kCamera, truth, map, PoseRefinementOptions(), 1);
  EXPECT_FALSE(right.moved);
  EXPECT_TRUE(right.map_from_camera.isApprox(truth));
  const Isometry3d elsewhere = looking({0, 0, 1.5}, {0, -3, 8});  // Nothing of the map is there.
  const PoseRefinement lost =
      refine_pose(image.points, image.normals, kCamera, elsewhere, map, PoseRefinementOptions(), 1);
  EXPECT_FALSE(lost.moved);
  EXPECT_EQ(lost.verdict, "too little of the map is in view");
}

const FrontState& state_of(const std::vector<FrontState>& states, const std::string& joint) {
  return *std::ranges::find(states, joint, &FrontState::joint);
}

TEST(ArticulatedFronts, DrawersAndDoorsAreFoundWhereTheyStand) {
  const mapping::World world = kitchen();
  const ArticulatedFronts fronts(world, {});
  const Isometry3d camera = looking({-0.3, -0.9, 1.4}, {0, 0.8, 0.5});
  for (const JointState& truth : {JointState{{"drawer_joint", 0.31}, {"door_joint", 0.9}}, JointState{},
                                  JointState{{"drawer_joint", 0.12}}}) {
    const Image image = image_of(scene_of(world, truth), camera);
    const auto states = fronts.estimate(image.points, kCamera, camera, {});
    for (const auto& [joint, tolerance] : {std::pair("drawer_joint", 0.005), std::pair("door_joint", 0.03)}) {
      const FrontState& state = state_of(states, joint);
      const double expected = truth.contains(joint) ? truth.at(joint) : 0;
      EXPECT_TRUE(state.determined) << joint;
      EXPECT_NEAR(state.position, expected, tolerance) << joint;
      EXPECT_EQ(state.moved, expected > 0) << joint;
    }
  }
}

TEST(ArticulatedFronts, AShiftByWhichADepthCameraDistortsIsNoOpening) {
  const mapping::World world = kitchen();
  const ArticulatedFronts fronts(world, {});
  const Image near =
      image_of(scene_of(world, {{"drawer_joint", 0.09}}), looking({-0.3, -0.4, 1.2}, {0, 0.8, 0.5}));
  const Image far =
      image_of(scene_of(world, {{"drawer_joint", 0.09}}), looking({-0.3, -2.4, 1.2}, {0, 0.8, 0.5}));
  const auto drawer = [&](const Image& image, double y) {
    return state_of(fronts.estimate(image.points, kCamera, looking({-0.3, y, 1.2}, {0, 0.8, 0.5}), {}),
                    "drawer_joint");
  };
  EXPECT_TRUE(drawer(near, -0.4).moved);
  EXPECT_FALSE(drawer(far, -2.4).moved);
  EXPECT_FALSE(drawer(far, -2.4).determined) << "it is not seen to be shut either";
}

FrontState seen_at(double position) {
  FrontState state;
  state.joint = "drawer_joint";
  state.position = position;
  state.determined = true;
  state.moved = position > 0;
  return state;
}

TEST(FrontTracks, InAVideoAFrontHasToBeSeenOpenForAWhile) {
  FrontTracks tracks;
  const auto settled = [&](double position, double second, bool in_video) {
    FrontState state = seen_at(position);
    tracks.settle(state, static_cast<TimeNs>(second * kSecond), in_video);
    return state;
  };
  EXPECT_TRUE(settled(0, 0, true).determined);
  EXPECT_FALSE(settled(0.2, 0.2, true).determined) << "one frame";
  EXPECT_TRUE(settled(0, 0.4, true).determined);
  EXPECT_FALSE(settled(0.2, 1.3, true).determined) << "what was seen before is void";
  EXPECT_FALSE(settled(0.3, 1.8, true).determined) << "it moves";
  EXPECT_FALSE(settled(0.31, 2.5, true).determined);
  const FrontState open = settled(0.3, 2.9, true);
  EXPECT_TRUE(open.determined);
  EXPECT_TRUE(open.moved);
  EXPECT_NEAR(open.position, 0.3, 1e-9);
  EXPECT_NEAR(settled(0.31, 3.1, true).position, 0.3, 1e-9) << "noise is not a motion";
}

TEST(FrontTracks, FramesThatLieApartCountAtOnce) {
  FrontTracks tracks;
  FrontState state = seen_at(0.2);
  tracks.settle(state, 0, false);
  EXPECT_TRUE(state.determined);
  EXPECT_TRUE(state.moved);
  state = seen_at(0);
  tracks.settle(state, 600 * kSecond, false);
  EXPECT_TRUE(state.determined);
  EXPECT_FALSE(state.moved);
}

TEST(KnownStructure, ADrawerHoldsWhatIsNoHigherThanItsFrontAndNothingWhileItIsShut) {
  const std::string bottom = box("drawer_1_bottom", "0.5 0.4 0.01") +
                             "<joint name=\"bottom_joint\" type=\"fixed\"><parent link=\"drawer\"/>"
                             "<child link=\"drawer_1_bottom\"/><origin xyz=\"0 0.2 -0.125\"/></joint>";
  mapping::World world = kitchen();
  const mapping::World part = world_of("<link name=\"drawer\"/>" + bottom);
  world.links.push_back(*part.find_link("drawer_1_bottom"));
  world.joints.push_back(*part.find_joint("bottom_joint"));
  Warnings warnings;
  const auto map = KnownMap::make(world, {}, {}, warnings);
  const auto surfaces = map->support_surfaces({"*drawer*bottom"});
  ASSERT_EQ(surfaces.size(), 1U);
  const Isometry3d camera = looking({-0.4, -0.5, 1.5}, {-0.4, 0.8, 0.5});
  for (const double open : {0.0, 0.3}) {
    const JointState joints{{"drawer_joint", open}};
    const Image image = image_of(scene_of(world, joints), camera);
    const KnownStructure known =
        find_known_structure(image.points, {}, kCamera, camera, *map, surfaces, joints, {}, 1);
    ASSERT_EQ(known.regions.size(), 1U);
    EXPECT_NEAR(known.regions[0].height_m, open > 0 ? 0.27 : 0, 1e-6);
  }
}

TEST(ArticulatedFronts, WhatHidesAFrontLeavesItsJointAndIsReported) {
  const mapping::World world = kitchen();
  const ArticulatedFronts fronts(world, {});
  const Isometry3d camera = looking({-0.4, -0.9, 0.9}, {-0.4, 0.8, 0.6});
  mapping::RenderScene seen = scene_of(world);
  Warnings warnings;
  seen.add("board", triangulate(mapping::Box{Vector3d(0.6, 0.04, 0.6)}, {}, warnings), at({-0.4, 0.31, 0.6}));
  const Image image = image_of(seen, camera);
  const FrontState drawer = state_of(fronts.estimate(image.points, kCamera, camera, {}), "drawer_joint");
  EXPECT_FALSE(drawer.determined);
  EXPECT_EQ(drawer.position, 0);
  const cv::Mat map_depth = scene_of(world).render(kCamera, camera).depth;
  cv::Mat unknown(kCamera.height, kCamera.width, CV_8U);
  for (int i = 0; i < unknown.rows * unknown.cols; ++i)
    unknown.ptr<uint8_t>()[i] = map_depth.ptr<float>()[i] - image.points.ptr<cv::Vec3f>()[i][2] > 0.03f;
  const auto obstacles = fronts.obstacles(image.points, unknown, kCamera, camera, {});
  ASSERT_EQ(obstacles.size(), 1U);
  EXPECT_EQ(obstacles[0].joint, "drawer_joint");
  EXPECT_NEAR(obstacles[0].distance_m, 0.77 - 0.29, 0.01);
  EXPECT_GT(obstacles[0].share, 0.8);
  const Image free = image_of(scene_of(world), camera);
  EXPECT_TRUE(
      fronts.obstacles(free.points, cv::Mat::zeros(unknown.size(), CV_8U), kCamera, camera, {}).empty());
}

/// A counter round a corner, higher than the table before it.
mapping::World corner_kitchen() {
  return world_of(
      "<link name=\"map\"/>" + box("floor", "6 6 0.02") + fixed("floor", "0 0 -0.01") +
      "<link name=\"counter\"><visual><origin xyz=\"0 1.2 0\"/><geometry><box size=\"3 0.6 0.9\"/>"
      "</geometry></visual><visual><origin xyz=\"-1.2 -0.12 0\"/><geometry>"
      "<box size=\"0.6 2 0.9\"/></geometry></visual></link>" +
      fixed("counter", "0 0 0.45") + box("table", "0.8 0.6 0.86") + fixed("table", "-0.2 0.3 0.43"));
}

TEST(KnownMap, SupportsGoRoundCorners) {
  Warnings warnings;
  const auto map = KnownMap::make(corner_kitchen(), {}, {}, warnings);
  const std::vector<SupportSurface> surfaces = map->support_surfaces({"counter", "table"});
  ASSERT_EQ(surfaces.size(), 2U);
  ASSERT_EQ(surfaces[0].outline.size(), 6U);
  EXPECT_EQ(surfaces[1].outline.size(), 4U);
  const auto inside = [&](double x, double y) {
    const Isometry3d top_from_map =
        (map->scene.map_from_link(surfaces[0].link_id) * surfaces[0].link_from_top).inverse();
    return PolygonOutline(surfaces[0].outline).inside((top_from_map * Vector3d(x, y, 0.9)).head<2>());
  };
  EXPECT_NEAR(inside(-1.2, 1.2), 0.3, 1e-5) << "the corner";
  EXPECT_NEAR(inside(0.5, 1.0), 0.1, 1e-5);
  EXPECT_NEAR(inside(-0.7, 0.7), -0.2, 0.01) << "before the corner";
}

TEST(KnownMap, NothingStandsOnTheEndsOfLegs) {
  std::string legs = "<link name=\"table_legs\">";
  for (const char* corner : {"0.5 0.3", "0.5 -0.3", "-0.5 0.3", "-0.5 -0.3"})
    legs += std::string("<visual><origin xyz=\"") + corner +
            " 0.35\"/><geometry><box size=\"0.06 0.06 0.7\"/></geometry></visual>";
  Warnings warnings;
  const auto map =
      KnownMap::make(world_of("<link name=\"map\"/>" + box("table", "1.1 0.7 0.03") +
                              fixed("table", "0 0 0.72") + legs + "</link>" + fixed("table_legs", "0 0 0")),
                     {}, {}, warnings);
  const std::vector<SupportSurface> surfaces = map->support_surfaces({"table*"});
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_EQ(surfaces[0].link, "table");
}

TEST(KnownStructure, ATableBeforeACornerKeepsWhatStandsOnIt) {
  Warnings warnings;
  const auto map = KnownMap::make(corner_kitchen(), {}, {}, warnings);
  const auto surfaces = map->support_surfaces({"counter", "table"});
  mapping::RenderScene seen = scene_of(corner_kitchen());
  seen.add("cup", cube(0.1), at({-0.4, 0.4, 0.91}));
  const Isometry3d camera = looking({0.6, -0.9, 1.6}, {-0.3, 0.4, 0.86});
  const mapping::RenderedView view = seen.render(kCamera, camera);
  const KnownStructure known = find_known_structure(points_from_depth(view.depth, kCamera), {}, kCamera,
                                                    camera, *map, surfaces, {}, {}, 1);
  int cup = 0, on_table = 0;
  for (int i = 0; i < view.link.rows * view.link.cols; ++i) {
    const int link = view.link.ptr<int>()[i], region = known.region.ptr<uint16_t>()[i];
    if (link < 0 || seen.link_names()[static_cast<size_t>(link)] != "cup") continue;
    ++cup;
    on_table += region > 0 && known.regions[static_cast<size_t>(region) - 1].surface->link == "table";
  }
  EXPECT_GT(cup, 100);
  EXPECT_EQ(on_table, cup);
}

/// An arm before the camera, its hand at the end of a joint.
const char* const kArm =
    "<robot name=\"arm\"><link name=\"base\"/><link name=\"camera\"/>"
    "<link name=\"hand\"><visual><origin xyz=\"0 0 0.6\"/><geometry><box size=\"0.1 0.1 0.1\"/></geometry>"
    "</visual></link>"
    "<joint name=\"eye\" type=\"fixed\"><parent link=\"base\"/><child link=\"camera\"/><origin xyz=\"0 0 "
    "0.2\" rpy=\"0 0.3 0\"/></joint>"
    "<joint name=\"reach\" type=\"revolute\"><parent link=\"camera\"/><child link=\"hand\"/>"
    "<axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";

TEST(KnownRobot, ItsBodyIsKnownWhereverItsJointsAndTheCameraAre) {
  const TemporaryFolder temporary("loci_test");
  const std::filesystem::path& folder = temporary.path();
  std::ofstream(folder / "arm.urdf") << kArm;
  std::ofstream(folder / "joints.csv") << "time_ns,joint,position\n100,reach,0\n200,reach,0.3\n";
  Warnings warnings;
  const auto map = KnownMap::make(kitchen(), {}, {}, warnings);
  map->add_robot(folder / "arm.urdf", folder / "joints.csv", {}, warnings);
  ASSERT_TRUE(warnings.empty());
  const auto surfaces = map->support_surfaces({"counter"});
  const Isometry3d camera = looking({-0.5, -0.8, 1.5}, {0, 1.2, 0.85});
  for (const auto& [time, angle] : {std::pair<TimeNs, double>(150, 0), std::pair<TimeNs, double>(250, 0.3)}) {
    mapping::RenderScene seen = scene_of(kitchen());
    const size_t cup = seen.add("cup", cube(0.1), at({0.2, 1.1, 0.9}));
    Isometry3d hand = Isometry3d::Identity();
    hand.rotate(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
    const size_t body = seen.add("hand", cube(0.1), camera * hand * at({0, 0, 0.6}));
    const mapping::RenderedView view = seen.render(kCamera, camera);
    map->place_robots(time, {}, "camera", camera);
    const KnownStructure known = find_known_structure(points_from_depth(view.depth, kCamera), {}, kCamera,
                                                      camera, *map, surfaces, {}, {}, 1);
    int wall_left = 0, hand_left = 0, hand_seen = 0, cup_kept = 0, cup_seen = 0;
    for (int i = 0; i < view.link.rows * view.link.cols; ++i) {
      const std::string name =
          view.link.ptr<int>()[i] < 0 ? "" : seen.link_names()[static_cast<size_t>(view.link.ptr<int>()[i])];
      const auto kind = static_cast<mapping::PixelKind>(known.kind.ptr<uint8_t>()[i]);
      hand_seen += name == "hand";
      hand_left += name == "hand" && kind != mapping::PixelKind::map_explained;
      cup_seen += name == "cup";
      cup_kept += name == "cup" && kind == mapping::PixelKind::region_of_interest;
      wall_left += name == "wall_east" && kind != mapping::PixelKind::map_explained;
    }
    EXPECT_GT(hand_seen, 500) << body;
    EXPECT_EQ(hand_left, 0) << angle;
    EXPECT_EQ(wall_left, 0) << angle;
    EXPECT_GT(cup_seen, 50) << cup;
    EXPECT_EQ(cup_kept, cup_seen) << angle;
    map->hide_robots();
  }
}

TEST(KnownRobot, JointsAreThoseOfTheLatestRow) {
  KnownRobot robot;
  EXPECT_TRUE(robot.joints_at(5).empty());
  robot.rows = {{100, {{"a", 1}}}, {200, {{"a", 1}, {"b", 2}}}};
  EXPECT_EQ(robot.joints_at(50).size(), 1U);
  EXPECT_EQ(robot.joints_at(199).size(), 1U);
  EXPECT_EQ(robot.joints_at(200).size(), 2U);
}

}  // namespace
}  // namespace loci::perception
