#include "mapping/interpretation/furniture/cabinets.h"

#include <gmock/gmock.h>

#include "mapping/articulation/articulation.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/world/contacts.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

using ::testing::ElementsAre;

/// Fronts look along x; u (to their right) is y.
Front a_front(const std::string& name, double u0, double u1, double v0, double v1, double handle_u = 0,
              bool upright = false) {
  Front front;
  front.name = name;
  front.centre = {0, (u0 + u1) / 2, (v0 + v1) / 2};
  front.width = u1 - u0;
  front.height = v1 - v0;
  front.confidence = 0.9;
  front.fixture = Fixture{};
  front.fixture->axis = upright ? Vector3d::UnitZ() : Vector3d::UnitY();
  front.fixture->length = 0.15;
  front.fixture->centre = {0.03, upright ? handle_u : front.centre.y(), v1 - 0.1};
  front.joint = joint_prior(front);
  front.class_name = front_class(front, *front.joint);
  return front;
}

/// A drawer over two wings, and a column of two drawers to their right; a wall 60 cm behind.
struct Row {
  World world;
  SemanticMap semantics;
  std::vector<Front> fronts = {
      a_front("drawer_1", 0, 0.8, 0.65, 0.85), a_front("door_1", 0, 0.4, 0.1, 0.65, 0.35, true),
      a_front("door_2", 0.4, 0.8, 0.1, 0.65, 0.45, true), a_front("drawer_2", 0.8, 1.3, 0.5, 0.85),
      a_front("drawer_3", 0.8, 1.3, 0.1, 0.5)};

  explicit Row(bool wall = true) {
    world.name = world.root = "map";
    world.links.resize(1);
    world.links[0].name = "map";
    if (wall) {
      add_link(world, "wall_west", "wall", "map", Isometry3d(Eigen::Translation3d(-0.6, 1, 1.2)),
               {box_part({-0.025, 0, 0}, {0.05, 4, 2.4})});
      semantics.links["wall_west"].class_name = "wall";
    }
    add_fronts(fronts, "map", world, semantics);
  }
};

TEST(Cabinets, AColumnOfFrontsAndTheWingsOfACupboardHaveOneBodyEach) {
  Row row;
  ASSERT_EQ(row.fronts[1].class_name, "door");
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  const SemanticLink& wide = row.semantics.links.at("cabinet_1");
  EXPECT_EQ(wide.class_name, "cabinet");
  EXPECT_THAT(wide.extra.at("fronts"), ElementsAre("drawer_1", "door_1", "door_2"));
  EXPECT_THAT(row.semantics.links.at("cabinet_2").extra.at("fronts"), ElementsAre("drawer_2", "drawer_3"));
  EXPECT_FALSE(row.semantics.links.contains("cabinet_3"));
  EXPECT_EQ(wide.evidence.at("depth"), "wall");
  EXPECT_NEAR(wide.geometry.at("height"), 0.1, 1e-9);
  EXPECT_NEAR(wide.geometry.at("top"), 0.85, 1e-9);
  for (const Json& corner : wide.geometry.at("outline")) {
    const double x = corner.at(0), y = corner.at(1);
    EXPECT_TRUE(std::abs(x + 0.023) < 1e-6 || std::abs(x + 0.589) < 1e-6) << x;
    EXPECT_TRUE(std::abs(y - 0.016) < 1e-6 || std::abs(y - 0.784) < 1e-6) << y;
  }
  const Vector3d origin = root_from_links(row.world, {})[row.world.link_index("cabinet_1")].translation();
  EXPECT_NEAR(origin.z(), 0.1, 1e-9);
}

TEST(Cabinets, TheCompartmentsOfARefrigeratorHaveOneBodyWithItsName) {
  Row row;
  std::vector<Front> fronts = {a_front("door_3", 1.4, 2, 0.1, 0.7, 1.45, true),
                               a_front("door_4", 1.4, 2, 0.7, 1.8, 1.45, true)};
  fronts[1].appliance = "fridge";
  add_fronts(fronts, "map", row.world, row.semantics);
  fronts.insert(fronts.begin(), row.fronts.begin(), row.fronts.end());
  add_cabinets(fronts, "map", row.world, row.semantics);
  const SemanticLink& fridge = row.semantics.links.at("fridge_1");
  EXPECT_EQ(fridge.class_name, "cabinet");
  EXPECT_EQ(fridge.appliance, "fridge");
  EXPECT_THAT(fridge.extra.at("fronts"), ElementsAre("door_3", "door_4"));
  EXPECT_TRUE(row.semantics.links.at("cabinet_1").appliance.empty());
  EXPECT_TRUE(row.semantics.links.contains("cabinet_2"));
  EXPECT_FALSE(row.semantics.links.contains("cabinet_3"));
  remove_cabinets(row.world, row.semantics);
  EXPECT_EQ(row.world.find_link("fridge_1"), nullptr);
}

TEST(Cabinets, NothingPenetratesAndEverythingStillOpens) {
  Row row;
  const World before = row.world;
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  const World world = parse_urdf(urdf_text(row.world), "map.urdf");
  EXPECT_TRUE(closed_contacts(world).empty());
  for (const Joint& joint : world.joints) {
    if (joint.type == JointType::fixed) continue;
    EXPECT_DOUBLE_EQ(joint.limits->upper, before.find_joint(joint.name)->limits->upper) << joint.name;
    EXPECT_TRUE(free_range(world, joint).blocker.empty()) << joint.name;
  }
}

void expect_all_open(const World& world, double min_slide) {
  EXPECT_TRUE(closed_contacts(world).empty());
  for (const Joint& joint : world.joints) {
    if (joint.type == JointType::fixed) continue;
    EXPECT_EQ(free_range(world, joint).blocker, "") << joint.name;
    EXPECT_GT(joint.limits->upper, min_slide) << joint.name;
  }
}

TEST(Cabinets, ADrawerThatRunsALittleAskewHasRoomInItsBody) {
  Row row;
  Front drawer = row.fronts[0];
  remove_front("drawer_1", row.world, row.semantics);
  drawer.up = Vector3d(-0.01, 0, 1).normalized();  // as the scans of a low face show it
  drawer.normal = Vector3d(1, 0.012, 0.01).normalized();
  drawer.joint->axis = drawer.normal;
  row.fronts[0] = drawer;
  add_front(drawer, "map", row.world, row.semantics);
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  expect_all_open(row.world, 0.4);
  const Isometry3d body = root_from_links(row.world, {})[row.world.link_index("cabinet_1")];
  EXPECT_NEAR(body.linear().determinant(), 1, 1e-9);
  EXPECT_NEAR(body.linear()(2, 2), 1, 1e-9) << "it stands upright";
}

TEST(Cabinets, FrontsFoundAsHighAsTheCounterOverThemEndBelowIt) {
  Row row;
  for (const Front& front : row.fronts) remove_front(front.name, row.world, row.semantics);
  add_link(row.world, "counter_1", "counter", "map", Isometry3d(Eigen::Translation3d(-0.3, 0.65, 0.844)),
           {box_part({0.005, 0, -0.02}, {0.6, 1.3, 0.04})});
  row.semantics.links["counter_1"].class_name = "counter";
  add_fronts(row.fronts, "map", row.world, row.semantics);
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  expect_all_open(row.world, 0.4);
  const std::vector<Collision>& slab = row.world.find_link("counter_1")->collisions;
  ASSERT_EQ(slab.size(), 1U) << "it is whole";
  EXPECT_NEAR(std::get<Box>(slab[0].geometry).size.y(), 1.3, 1e-9);
  EXPECT_GE(std::get<Box>(slab[0].geometry).size.z(), 0.0099);
}

TEST(Cabinets, AFrontThatContradictsOthersGivesWayToThoseThatWereMoved) {
  Row row;
  Front ghost = a_front("drawer_9", 0.7, 1.25, 0.42, 0.8);  // between drawer_2 and drawer_3, and beyond
  row.fronts[3].joint->evidence = row.fronts[4].joint->evidence = "interaction";
  ghost.confidence = 0.95;
  row.fronts.push_back(ghost);
  for (size_t i = 0; i < 5; ++i) remove_front(row.fronts[i].name, row.world, row.semantics);
  add_fronts(row.fronts, "map", row.world, row.semantics);
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  expect_all_open(row.world, 0.3);
  const Link& moved = *row.world.find_link("drawer_2_front");
  ASSERT_EQ(moved.collisions.size(), 1U);
  EXPECT_GT(std::get<Box>(moved.collisions[0].geometry).size.y(), 0.48);
}

TEST(Cabinets, WithoutAWallTheDepthIsThatOfTheFrontsAndSaidToBeAssumed) {
  Row row(false);
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  const SemanticLink& cabinet = row.semantics.links.at("cabinet_1");
  EXPECT_EQ(cabinet.evidence.at("depth"), "assumed");
  EXPECT_LT(cabinet.confidence, 0.9);
}

TEST(Cabinets, RemovingThemLeavesTheMapAsItWas) {
  Row row;
  const std::string before = urdf_text(row.world) + to_json(row.semantics).dump();
  add_cabinets(row.fronts, "map", row.world, row.semantics);
  remove_cabinets(row.world, row.semantics);
  EXPECT_EQ(urdf_text(row.world) + to_json(row.semantics).dump(), before);
}

}  // namespace
}  // namespace loci::mapping
