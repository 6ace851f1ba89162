#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/interpretation/furniture/front_fit.h"

#include <gmock/gmock.h>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/world/contacts.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

using ::testing::UnorderedElementsAre;

struct Map {
  World world;
  SemanticMap semantics;

  Map() {
    world.name = "map";
    world.root = "map";
    world.links.resize(2);
    world.links[0].name = "map";
    world.links[1].name = "counter_1";
    Joint joint;
    joint.name = "counter_1_joint";
    joint.parent = "map";
    joint.child = "counter_1";
    joint.parent_from_joint = Eigen::Translation3d(1, 2, 0.9) * Eigen::AngleAxisd(0.7, Vector3d::UnitZ());
    world.joints = {joint};
  }

  Isometry3d pose(const std::string& link, const JointState& state = {}) const {
    return root_from_links(world, state)[world.link_index(link)];
  }
  std::vector<std::string> links() const {
    std::vector<std::string> names;
    for (const Link& link : world.links) names.push_back(link.name);
    return names;
  }
};

Front a_front(const std::string& name) {
  Front front;
  front.name = name;
  front.class_name = name.substr(0, name.find('_'));
  front.normal = Vector3d(0.6, -0.8, 0);
  front.centre = Vector3d(1.3, 1.7, 0.61);
  front.width = 0.6;
  front.height = 0.2;
  front.depth = 0.45;
  front.depth_measured = true;
  front.appliance = "oven";
  front.confidence = 0.83;
  front.evidence = {{"inliers", 412}, {"scans", {0, 3}}};
  Fixture bar;
  bar.centre = front.centre + 0.035 * front.normal + Vector3d(0, 0, 0.05);
  bar.axis = front.right();
  bar.length = 0.16;
  bar.radius = 0.007;
  bar.protrusion = 0.035;
  bar.confidence = 0.9;
  bar.evidence = {{"inliers", 61}};
  front.fixture = bar;
  return front;
}

Front a_drawer() {
  Front front = a_front("drawer_3");
  JointEstimate joint;
  joint.type = ArticulationType::prismatic;
  joint.probabilities = {0.05, 0.9, 0.05};
  // Real drawers run a few degrees off their front's normal.
  joint.axis = Eigen::AngleAxisd(0.04, Vector3d::UnitZ()) * front.normal;
  joint.upper = 0.4;
  joint.axis_sd_deg = 1.5;
  joint.evidence = "interaction";
  front.joint = joint;
  return front;
}

Front a_door() {
  Front front = a_front("door_2");
  front.height = 0.7;
  JointEstimate joint;
  joint.type = ArticulationType::revolute;
  joint.probabilities = {0.1, 0.2, 0.7};
  joint.axis = Vector3d::UnitZ();
  joint.origin = front.centre - 0.3 * front.right();
  joint.upper = 1.5;
  joint.origin_sd_m = 0.02;
  front.joint = joint;
  front.fixture->kind = Fixture::Kind::knob;
  front.fixture->axis = front.normal;
  front.fixture->length = 0.03;
  front.fixture->radius = 0.015;
  return front;
}

void expect_equal(const Front& a, const Front& b) {
  constexpr double kEqual = 1e-9;
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.class_name, b.class_name);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.up, b.up);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.depth_measured, b.depth_measured);
  EXPECT_EQ(a.appliance, b.appliance);
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_EQ(a.evidence, b.evidence);
  ASSERT_EQ(a.fixture.has_value(), b.fixture.has_value());
  if (a.fixture) {
    EXPECT_EQ(a.fixture->kind, b.fixture->kind);
    EXPECT_EQ(a.fixture->centre, b.fixture->centre);
    EXPECT_EQ(a.fixture->axis, b.fixture->axis);
    EXPECT_EQ(a.fixture->length, b.fixture->length);
    EXPECT_EQ(a.fixture->radius, b.fixture->radius);
    EXPECT_EQ(a.fixture->protrusion, b.fixture->protrusion);
    EXPECT_EQ(a.fixture->confidence, b.fixture->confidence);
    EXPECT_EQ(a.fixture->evidence, b.fixture->evidence);
  }
  ASSERT_EQ(a.joint.has_value(), b.joint.has_value());
  if (a.joint) {
    EXPECT_EQ(a.joint->type, b.joint->type);
    EXPECT_EQ(a.joint->probabilities, b.joint->probabilities);
    EXPECT_EQ(a.joint->evidence, b.joint->evidence);
    EXPECT_LT((a.joint->axis - b.joint->axis).norm(), kEqual);
    EXPECT_LT((a.joint->origin - b.joint->origin).norm(), kEqual);
    EXPECT_NEAR(a.joint->lower, b.joint->lower, kEqual);
    EXPECT_NEAR(a.joint->upper, b.joint->upper, kEqual);
    EXPECT_EQ(a.joint->axis_sd_deg, b.joint->axis_sd_deg);
    EXPECT_EQ(a.joint->origin_sd_m, b.joint->origin_sd_m);
  }
}

TEST(FurnitureLinks, DrawerBecomesThePrototypeUnderOneJoint) {
  Map map;
  add_front(a_drawer(), "counter_1", map.world, map.semantics);
  EXPECT_THAT(map.links(),
              UnorderedElementsAre("map", "counter_1", "drawer_3_front", "drawer_3_left", "drawer_3_right",
                                   "drawer_3_back", "drawer_3_bottom", "drawer_3_handle"));
  for (const Joint& joint : map.world.joints) {
    EXPECT_EQ(joint.name, joint.child + "_joint");
    EXPECT_EQ(joint.type != JointType::fixed, joint.child == "drawer_3_front");
  }
  const std::map<std::string, std::string> classes = {
      {"drawer_3_front", "drawer"},         {"drawer_3_left", "drawer_side"},
      {"drawer_3_right", "drawer_side"},    {"drawer_3_back", "drawer_side"},
      {"drawer_3_bottom", "drawer_bottom"}, {"drawer_3_handle", "handle"}};
  ASSERT_EQ(map.semantics.links.size(), classes.size());
  for (const auto& [name, class_name] : classes)
    EXPECT_EQ(map.semantics.links.at(name).class_name, class_name);
}

TEST(FurnitureLinks, FrontFrameHasXOutwardAndZUpInTheCentre) {
  for (const Front& front : {a_drawer(), a_door(), a_front("front_1")}) {
    Map map;
    add_front(front, "counter_1", map.world, map.semantics);
    const std::string frame = front.class_name == "front" ? front.name : front.name + "_front";
    const Isometry3d pose = map.pose(frame);
    EXPECT_LT((pose.translation() - front.centre).norm(), 1e-12) << frame;
    EXPECT_LT((pose.linear().col(0) - front.normal).norm(), 1e-12) << frame;
    EXPECT_LT((pose.linear().col(2) - front.up).norm(), 1e-12) << frame;
  }
}

TEST(FurnitureLinks, OpeningMovesDrawerAlongItsAxisWithAllThatBelongsToIt) {
  Map map;
  const Front drawer = a_drawer();
  add_front(drawer, "counter_1", map.world, map.semantics);
  for (const char* part : {"_front", "_left", "_right", "_back", "_bottom", "_handle"}) {
    const Vector3d moved =
        map.pose("drawer_3" + std::string(part), {{"drawer_3_front_joint", 0.3}}).translation() -
        map.pose("drawer_3" + std::string(part)).translation();
    EXPECT_LT((moved - 0.3 * drawer.joint->axis).norm(), 1e-12) << part;
  }
}

TEST(FurnitureLinks, OpeningTurnsDoorAboutItsHinge) {
  Map map;
  const Front door = a_door();
  add_front(door, "counter_1", map.world, map.semantics);
  const Isometry3d turn = Eigen::Translation3d(door.joint->origin) *
                          Eigen::AngleAxisd(0.8, door.joint->axis) *
                          Eigen::Translation3d(-door.joint->origin);
  for (const char* part : {"door_2", "door_2_front", "door_2_knob"})
    EXPECT_TRUE(map.pose(part, {{"door_2_joint", 0.8}}).isApprox(turn * map.pose(part), 1e-12)) << part;
}

TEST(FurnitureLinks, EveryLinkWithGeometryCanBeSimulated) {
  Map map;
  double aside = 0;
  for (Front front : {a_drawer(), a_door(), a_front("front_1")}) {
    const Vector3d shift = aside * front.right();
    front.centre += shift;
    front.fixture->centre += shift;
    if (front.joint) front.joint->origin += shift;
    add_front(front, "counter_1", map.world, map.semantics);
    aside += 1;
  }
  for (const Link& link : map.world.links) {
    EXPECT_EQ(link.visuals.size(), link.collisions.size()) << link.name;
    EXPECT_EQ(link.visuals.empty(), !link.inertial.has_value()) << link.name;
    if (!link.inertial) continue;
    EXPECT_GT(link.inertial->mass, 0.01) << link.name;
    const Eigen::Vector3d moments =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(link.inertial->inertia).eigenvalues();
    EXPECT_GT(moments.x(), 0) << link.name;
    EXPECT_GT(moments.x() + moments.y(), moments.z() * (1 - 1e-9)) << link.name;  // of a real body
  }
}

TEST(FurnitureLinks, FrontsComeBackAsTheyWereWritten) {
  Map map;
  const std::vector<Front> fronts = {a_door(), a_drawer(), a_front("front_1")};
  for (const Front& front : fronts) add_front(front, "counter_1", map.world, map.semantics);
  const std::vector<Front> back = fronts_of(map.world, map.semantics);
  ASSERT_EQ(back.size(), fronts.size());
  for (size_t i = 0; i < fronts.size(); ++i) expect_equal(fronts[i], back[i]);
}

TEST(FurnitureLinks, FrontsSurviveTheFiles) {
  Map map;
  add_front(a_door(), "counter_1", map.world, map.semantics);
  add_front(a_drawer(), "counter_1", map.world, map.semantics);
  const World world = parse_urdf(urdf_text(map.world), "map.urdf");
  const SemanticMap semantics =
      semantic_map_from_json(parse_json(to_json(map.semantics).dump(), "map.json"), "map.json");
  const std::vector<Front> back = fronts_of(world, semantics);
  ASSERT_EQ(back.size(), 2U);
  expect_equal(a_door(), back[0]);
  expect_equal(a_drawer(), back[1]);
}

TEST(FurnitureLinks, RemovingLeavesTheMapAsItWas) {
  Map map;
  add_front(a_front("front_1"), "counter_1", map.world, map.semantics);
  const std::string before = urdf_text(map.world) + to_json(map.semantics).dump();
  for (const Front& front : {a_drawer(), a_door()}) {
    add_front(front, "counter_1", map.world, map.semantics);
    remove_front(front.name, map.world, map.semantics);
    EXPECT_EQ(urdf_text(map.world) + to_json(map.semantics).dump(), before);
  }
  EXPECT_THROW(remove_front("drawer_3", map.world, map.semantics), Error);
}

TEST(FurnitureLinks, NameIsTakenOnce) {
  Map map;
  add_front(a_drawer(), "counter_1", map.world, map.semantics);
  EXPECT_THROW(add_front(a_drawer(), "counter_1", map.world, map.semantics), Error);
}

TEST(FurnitureLinks, ReadsTheFrontsOfASampleMadeByHand) {
  const std::filesystem::path urdf = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";
  const std::vector<Front> fronts = fronts_of(read_urdf(urdf), read_semantic_map(sidecar_path(urdf)));
  ASSERT_EQ(fronts.size(), 8U);  // Five doors, three drawers.
  for (const Front& front : fronts) ASSERT_TRUE(front.joint && front.fixture) << front.name;
  const Front& door = fronts[0];
  EXPECT_EQ(door.name, "door_1");
  EXPECT_EQ(door.joint->type, ArticulationType::revolute);
  EXPECT_LT((door.joint->axis - Vector3d(0, 0, -1)).norm(), 1e-6);
  EXPECT_NEAR(door.joint->origin.x(), door.centre.x() - door.width / 2, 1e-6);
  const Front& drawer = fronts[5];
  EXPECT_EQ(drawer.name, "drawer_1");
  EXPECT_EQ(drawer.joint->type, ArticulationType::prismatic);
  EXPECT_LT((drawer.joint->axis - Vector3d(0, -1, 0)).norm(), 1e-6);
  EXPECT_NEAR(drawer.joint->upper, 0.5, 1e-12);
  EXPECT_NEAR(drawer.fixture->length, 0.24, 1e-12);
  EXPECT_NEAR(drawer.fixture->protrusion, 0.035, 1e-9);
}

/// A door whose hinge was found behind its face, beside a drawer that is a little too wide, both in the slab.
struct TightMap : Map {
  TightMap() {
    world.links[1].collisions.push_back(
        {"", Isometry3d(Eigen::Translation3d(0, 0, -0.02)), Box{{4, 4, 0.04}}});
    semantics.links["counter_1"].class_name = "counter";
    Front door = a_door(), drawer = a_drawer();
    door.joint->origin -= 0.01 * door.normal;
    door.centre.z() = 0.9 - 0.038 - door.height / 2;
    drawer.centre = door.centre + 0.598 * door.right();
    drawer.joint->axis = drawer.normal;
    drawer.confidence = 0.99;
    for (Front* front : {&door, &drawer}) front->fixture->centre = front->centre + 0.035 * front->normal;
    add_fronts({door, drawer}, "map", world, semantics);
  }
};

TEST(FurnitureLinks, FrontsKeepTheGapsOfFurnitureWhateverTheirExtents) {
  const TightMap map;
  EXPECT_TRUE(closed_contacts(map.world).empty());
  for (const char* name : {"door_2_joint", "drawer_3_front_joint"}) {
    const Joint& joint = *map.world.find_joint(name);
    const FreeRange range = free_range(map.world, joint);
    EXPECT_EQ(range.blocker, "") << name;
    EXPECT_GT(range.upper, 0.39) << name;
  }
  // The sidecar keeps what was measured.
  EXPECT_EQ(map.semantics.links.at("door_2").geometry.at("width").get<double>(), 0.6);
}

/// A map of a drawer and something that stands at a pose in the frame of its front.
Map with_obstacle(const Isometry3d& front_from_obstacle, const Geometry& shape) {
  const Front front = a_drawer();
  Map map;
  Link obstacle;
  obstacle.name = "obstacle";
  obstacle.collisions.push_back({"", map_from_front(front) * front_from_obstacle, shape});
  map.world.links.push_back(obstacle);
  Joint joint;
  joint.name = "obstacle_joint";
  joint.parent = "map";
  joint.child = "obstacle";
  map.world.joints.push_back(joint);
  add_front(front, "map", map.world, map.semantics);
  return map;
}

TEST(FurnitureLinks, ADrawerThatMeetsSomethingOpensUpToIt) {
  const Map map = with_obstacle(Isometry3d(Eigen::Translation3d(0.3, 0, 0)), Cylinder{0.02, 1});
  EXPECT_EQ(map.semantics.links.at("drawer_3_front").extra.at("blocked_by"), "obstacle");
  EXPECT_NEAR(map.world.find_joint("drawer_3_front_joint")->limits->upper, 0.3 - 0.02 - 0.04, 0.01);
}

double depth_of_drawer(const Map& map) {
  return map.semantics.links.at("drawer_3_left").geometry.at("width").get<double>();
}

TEST(FurnitureLinks, ADrawerEndsBeforeAWallThatStandsAskew) {
  // The face of the wall is 0.3 m behind the front in its middle, and nearer on one side.
  const Isometry3d askew = Eigen::Translation3d(-0.3, 0, 0) * Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) *
                           Eigen::Translation3d(-0.025, 0, 0);
  const Map map = with_obstacle(askew, Box{{0.05, 4, 2}});
  EXPECT_TRUE(closed_contacts(map.world).empty());
  EXPECT_NEAR(depth_of_drawer(map), 0.3 - 0.02 - 0.3 * std::tan(0.5), 0.03);
}

TEST(FurnitureLinks, ADrawerBesideACornerIsNarrower) {
  // The panel of the next face begins behind the end of the drawer's front.
  const Isometry3d corner(Eigen::Translation3d(-0.32, 0.285, 0));
  const Map map = with_obstacle(corner, Box{{0.6, 0.02, 0.6}});
  EXPECT_TRUE(closed_contacts(map.world).empty());
  EXPECT_NEAR(depth_of_drawer(map), 0.43, 0.01) << "it is as deep as it was";
}

}  // namespace
}  // namespace loci::mapping
