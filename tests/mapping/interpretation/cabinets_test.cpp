#include "mapping/interpretation/furniture/cabinets.h"

#include <gmock/gmock.h>

#include "mapping/articulation/articulation.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/interpretation/furniture/wings.h"
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

/// A door without fixture: a_front() without its handle.
Front a_bare_door(double u0, double u1) {
  Front front = a_front("door", u0, u1, 0.1, 0.85);
  front.fixture.reset();
  front.joint = joint_prior(front);
  front.class_name = front_class(front, *front.joint);
  return front;
}

TEST(Cabinets, DoorsWithoutHandleOpenAwayFromTheOtherOneOfAPair) {
  // A pair, a door with a handle, and one without for which nothing shows the side.
  std::vector<Front> fronts = {a_bare_door(0.4, 0.8), a_bare_door(0, 0.4),
                               a_front("door", 0.8, 1.2, 0.1, 0.85, 0.85, true), a_bare_door(1.2, 1.62)};
  ASSERT_EQ(fronts[0].class_name, "door");
  pair_wings(fronts);
  EXPECT_EQ(fronts[0].joint->hinge_from, "pair");
  EXPECT_GT(fronts[0].joint->axis.z(), 0);
  EXPECT_NEAR(fronts[0].joint->origin.y(), 0.8, 1e-9);
  EXPECT_EQ(fronts[1].joint->hinge_from, "pair");
  EXPECT_LT(fronts[1].joint->axis.z(), 0);
  EXPECT_NEAR(fronts[1].joint->origin.y(), 0, 1e-9);
  EXPECT_EQ(fronts[2].joint->hinge_from, "");
  EXPECT_EQ(fronts[3].joint->hinge_from, "assumed");
}

TEST(Cabinets, OfThreeEqualDoorsWithoutHandleItIsOpenWhichAreAPair) {
  std::vector<Front> fronts = {a_bare_door(0, 0.4), a_bare_door(0.4, 0.8), a_bare_door(0.8, 1.2)};
  pair_wings(fronts);
  for (const Front& front : fronts) EXPECT_EQ(front.joint->hinge_from, "assumed");
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
