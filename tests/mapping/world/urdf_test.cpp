#include "mapping/world/urdf.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "tests/mapping/world/equal_worlds.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path kRobots = fs::path(LOCI_SHARED_DIR) / "data" / "robots";

std::string message_of(const std::string& text) {
  try {
    parse_urdf(text, "file.urdf");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

std::string robot(const std::string& inside) {
  return "<robot name=\"r\">\n" + inside + "\n</robot>";
}

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& inside = {}, const std::string& type = "fixed") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + inside + "</joint>\n";
}

std::string geometry(const std::string& shape) {
  return robot("<link name=\"a\"><visual><geometry>" + shape + "</geometry></visual></link>");
}

TEST(Urdf, ReadsWhatEveryElementSays) {
  const World world = parse_urdf(
      R"(<robot name="cupboard" xmlns:drake="http://drake.mit.edu">
           <material name="oak"><color rgba="0.5 0.25 0.125 1"/></material>
           <link name="body" type="furniture"><visual name="front"><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>
             <geometry><box size="0.1 0.2 0.3"/></geometry><material name="oak"/></visual></link>
           <link name="door"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="3"/>
             </inertial><collision><geometry><mesh filename="package://p/door.stl" scale="1 1 -2"/></geometry></collision></link>
           <joint name="hinge" type="revolute"><parent link="body"/><child link="door"/><axis xyz="0 0 1"/>
             <limit drake:acceleration="8.5" lower="-1" upper="1.5" effort="3" velocity="4"/>
             <safety_controller k_velocity="10" soft_lower_limit="-0.5"/><calibration rising="0.25"/>
             <dynamics damping="0.5"/></joint>
           <gazebo reference="door"><mu1>0.5</mu1></gazebo>
         </robot>)",
      "cupboard.urdf");
  EXPECT_EQ(world.name, "cupboard");
  EXPECT_EQ(world.root, "body");
  ASSERT_EQ(world.links.size(), 2u);
  const Visual& front = world.links[0].visuals.at(0);
  EXPECT_EQ(front.name, "front");
  EXPECT_EQ(std::get<Box>(front.geometry).size, Vector3d(0.1, 0.2, 0.3));
  EXPECT_TRUE((front.link_from_visual * Vector3d::UnitX()).isApprox(Vector3d(1, 3, 3), 1e-12));
  EXPECT_EQ(front.material->color, Rgba(0.5f, 0.25f, 0.125f, 1));
  EXPECT_EQ(world.links[0].attributes.at("type"), "furniture");
  EXPECT_EQ(world.links[1].inertial->inertia(2, 2), 3);
  EXPECT_EQ(std::get<Mesh>(world.links[1].collisions.at(0).geometry).scale, Vector3d(1, 1, -2));
  const Joint& hinge = world.joints.at(0);
  EXPECT_EQ(hinge.limits->upper, 1.5);
  EXPECT_EQ(hinge.safety->soft_lower, -0.5);
  EXPECT_EQ(hinge.calibration->rising, 0.25);
  EXPECT_FALSE(hinge.calibration->falling);
  EXPECT_EQ(hinge.dynamics->damping, 0.5);
  EXPECT_EQ(hinge.attributes.at("limit/drake:acceleration"), "8.5");
  EXPECT_EQ(world.attributes.at("xmlns:drake"), "http://drake.mit.edu");
  ASSERT_EQ(world.extensions.size(), 1u);
  EXPECT_THAT(world.extensions[0], HasSubstr("<mu1>0.5</mu1>"));
}

TEST(Urdf, RefusesBadTextWithReasonAndLine) {
  const std::string two = "<link name=\"a\"/>\n<link name=\"b\"/>\n";
  const std::vector<std::pair<std::string, std::string>> table = {
      {"hello", "not XML"},
      {"", "empty"},
      {"<robot name=\"r\"><link", "not XML"},
      {"<sdf/>", "<sdf>, not <robot>"},
      {robot(""), "no links"},
      {robot("<link/>"), "file.urdf:2: a link has no name"},
      {robot("<link name=\"a\"/>\n<link name=\"a\"/>"), "file.urdf:3: link 'a' is not unique"},
      {robot(two), "two root links, 'a' and 'b'"},
      {robot(two + joint("j", "a", "c")), "file.urdf:4: child link 'c' of joint 'j' not found"},
      {robot(two + joint("j", "body", "b")), "parent link 'body' of joint 'j' not found"},
      {robot(two + joint("j", "a", "b") + joint("k", "b", "a")), "cycle: b → a → b"},
      {robot(two + "<link name=\"c\"/>" + joint("j", "a", "b") + joint("k", "b", "a")), "cycle: b → a → b"},
      {robot(two + joint("j", "a", "a") + joint("k", "a", "b")), "cycle: a → a"},
      {robot(two + "<link name=\"c\"/>" + joint("j", "a", "b") + joint("k", "c", "b")),
       "child of two joints, 'j' and 'k'"},
      {robot(two + joint("j", "a", "b") + joint("j", "a", "b")), "joint 'j' is not unique"},
      {robot(two + joint("j", "a", "b", "", "prismatic")), "joint 'j' is prismatic without limits"},
      {robot(two + joint("j", "a", "b", "", "hinge")), "unknown type 'hinge'"},
      {robot(two + joint("j", "a", "b", "<axis xyz=\"0 0 0\"/>", "continuous")),
       "axis of joint 'j' is 0 0 0"},
      {robot(two + joint("j", "a", "b", "<mimic joint=\"k\"/>", "continuous")),
       "mimics 'k', which does not exist"},
      {robot(two + joint("j", "a", "b", "<mimic joint=\"j\"/>", "continuous")), "mimics itself"},
      {robot(two + joint("j", "a", "b", "<origin xyz=\"0 nan 0\"/>")), "not finite"},
      {geometry("<box size=\"1 2 nan\"/>"), "'size' of <box> in link 'a' is \"1 2 nan\", not finite"},
      {geometry("<box size=\"1 2\"/>"), "not 3 numbers"},
      {geometry("<box/>"), "'size' of <box> in link 'a' is missing"},
      {geometry("<sphere radius=\"inf\"/>"), "not finite"},
      {geometry("<sphere radius=\"0\"/>"), "not positive"},
      {geometry("<cylinder radius=\"0.1\" length=\"-1\"/>"), "not positive"},
      {geometry("<cone radius=\"0.1\"/>"), "unknown geometry <cone>"},
      {geometry(""), "is empty"},
      {geometry("<mesh/>"), "no filename"},
  };
  for (const auto& [text, reason] : table) EXPECT_THAT(message_of(text), HasSubstr(reason)) << text;
}

TEST(Urdf, TextIsReadInTheEncodingThatItDeclares) {
  const std::string latin1 =
      "<robot name=\"K\xFC"
      "che\"><link name=\"t\xFCr\"/></robot>";
  const World world = parse_urdf("<?xml version='1.0' encoding='ISO-8859-1'?>\n" + latin1, "file.urdf");
  EXPECT_EQ(world.name, "Küche");
  EXPECT_EQ(world.links[0].name, "tür");
  EXPECT_EQ(parse_urdf(urdf_text(world), "again.urdf").name, "Küche");
  EXPECT_THAT(message_of("<?xml version='1.0'?>\n" + latin1), HasSubstr("file.urdf:2: this is not UTF-8"));
}

TEST(Urdf, AXacroIsNamedWithTheCommandThatExpandsIt) {
  const std::string used = "<robot name=\"r\" xmlns:xacro=\"http://wiki.ros.org/xacro\">\n";
  try {
    parse_urdf(used + "<xacro:property name=\"w\" value=\"1\"/>\n<link name=\"a\"/></robot>", "in.xacro");
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("in.xacro:2: this is a xacro"));
    EXPECT_THAT(error.hint(), HasSubstr("xacro in.xacro > "));
  }
  EXPECT_EQ(message_of(used + "<link name=\"a\"/></robot>"), "accepted");  // It was expanded.
}

TEST(Urdf, ErrorsAreOneLine) {
  EXPECT_EQ(message_of(robot("<link name=\"a\"><visual><geometry/></visual></link>")).find('\n'),
            std::string::npos);
}

TEST(Urdf, MaterialThatNobodyDefinesKeepsItsName) {
  const World world = parse_urdf(robot("<link name=\"a\"><visual><geometry><sphere radius=\"1\"/></geometry>"
                                       "<material name=\"oak\"/></visual></link>"),
                                 "oak");
  ASSERT_TRUE(world.links[0].visuals[0].material);
  EXPECT_EQ(world.links[0].visuals[0].material->name, "oak");
  EXPECT_FALSE(world.links[0].visuals[0].material->color);
  expect_equal(parse_urdf(urdf_text(world), "again"), world, 0);
}

TEST(Urdf, RoundTripKeepsRandomPoses) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-3.2, 3.2);
  World world;
  world.name = "poses";
  world.root = "link_0";
  for (int i = 0; i < 300; ++i) {
    world.links.push_back({});
    world.links.back().name = "link_" + std::to_string(i);
    if (i == 0) continue;
    Joint joint;
    joint.name = "joint_" + std::to_string(i);
    joint.parent = "link_0";
    joint.child = world.links.back().name;
    // Every third pitch is ±90° to within a little: roll and yaw are then only determined together.
    const double pitch = i % 3 ? angle(random) : (i % 2 ? 1 : -1) * (kPi / 2 + std::pow(10.0, -(i % 17)));
    joint.parent_from_joint.linear() = rotation_from_rpy({angle(random), pitch, angle(random)});
    joint.parent_from_joint.translation() = Vector3d(angle(random), angle(random), 1.0 / 3);
    world.joints.push_back(joint);
  }
  expect_equal(parse_urdf(urdf_text(world), "again"), world, 2e-14);
}

TEST(Urdf, RoundTripKeepsMaterials) {
  const World world = parse_urdf(robot(R"(<material name="unused"><color rgba="0 0 1 0.5"/></material>
               <material name="wood"><texture filename="wood.png"/></material>
               <link name="a"><visual><geometry><sphere radius="1"/></geometry><material name="wood"/></visual>
               <visual><geometry><sphere radius="2"/></geometry><material name="own"><color rgba="0.1 0.2 0.3 1"/></material></visual>
               <visual><geometry><sphere radius="3"/></geometry><material name="own"/></visual></link>)"),
                                 "materials");
  ASSERT_EQ(world.materials.size(), 2u);
  EXPECT_EQ(world.links[0].visuals[0].material->texture, "wood.png");
  EXPECT_FALSE(world.links[0].visuals[0].material->color);
  EXPECT_EQ(world.links[0].visuals[2].material->color, Rgba(0.1f, 0.2f, 0.3f, 1));
  expect_equal(parse_urdf(urdf_text(world), "again"), world, 0);
}

TEST(Urdf, TwoMaterialsOfOneNameAreNotWritten) {
  World world = parse_urdf(geometry("<sphere radius=\"1\"/>"), "one");
  world.links[0].visuals.push_back(world.links[0].visuals[0]);
  world.links[0].visuals[0].material = Material{"oak", Rgba(1, 0, 0, 1), ""};
  world.links[0].visuals[1].material = Material{"oak", Rgba(0, 1, 0, 1), ""};
  EXPECT_THROW(urdf_text(world), Error);
}

TEST(Urdf, NamesWithMarkupSurvive) {
  World world = parse_urdf(geometry("<sphere radius=\"1\"/>"), "one");
  world.name = "a <\"strange\"> & name";
  world.links[0].name = world.root = "drawer <1> & 'co'";
  expect_equal(parse_urdf(urdf_text(world), "again"), world, 0);
}

TEST(Urdf, AcceptedRobotsReadBackEqual) {
  if (!fs::exists(kRobots)) GTEST_SKIP() << "no shared data";
  // pr2.urdf names 92 links, 42 of them inside comments.
  const std::map<std::string, std::pair<size_t, std::string>> known = {
      {"pr2", {50, "base_footprint"}},
      {"turtlebot2", {40, "base_footprint"}},
      {"turtlebot3_burger", {7, ""}},
      {"panda", {17, "panda_link0"}},
      {"ur5", {11, "world"}},
      {"fetch", {19, "base0"}},
      {"iiwa14_primitive_collision", {11, ""}}};
  for (const auto& [name, facts] : known) {
    SCOPED_TRACE(name);
    const World world = read_urdf(kRobots / (name + ".urdf"));
    EXPECT_EQ(world.links.size(), facts.first);
    if (!facts.second.empty()) {
      EXPECT_EQ(world.root, facts.second);
    }
    expect_equal(parse_urdf(urdf_text(world), "again"), world, 2e-14);
  }
}

TEST(Urdf, LimitsInReverseOrderAreSwappedWithOneWarning) {
  const std::string text = robot(
      "<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>" +
      joint("left", "a", "b", "<limit lower=\"0\" upper=\"-1.5\" effort=\"1\" velocity=\"1\"/>", "revolute") +
      joint("right", "a", "c", "<limit lower=\"0.2\" upper=\"0\" effort=\"1\" velocity=\"1\"/>",
            "prismatic"));
  Warnings warnings;
  const World world = parse_urdf(text, "file.urdf", warnings);
  EXPECT_EQ(world.find_joint("left")->limits->lower, -1.5);
  EXPECT_EQ(world.find_joint("left")->limits->upper, 0);
  EXPECT_EQ(world.find_joint("right")->limits->upper, 0.2);
  ASSERT_EQ(warnings.texts().size(), 1U);
  EXPECT_THAT(warnings.texts()[0], HasSubstr("swapped, of left, right"));
}

TEST(Urdf, RejectedRobotsAreRefusedWithTheReason) {
  if (!fs::exists(kRobots)) GTEST_SKIP() << "no shared data";
  const std::map<std::string, std::vector<std::string>> reasons = {
      {"reject_pr2_simplified", {"joint 'x'", "prismatic without limits"}},
      {"reject_spot_arm", {"parent link 'body' of joint 'base_arm_joint' not found"}},
      {"reject_r2_left_gripper", {"link 'r2/left_leg/ati' is not unique"}},
      {"reject_two_roots_turtlebot3_burger", {"two root links", "base_footprint", "wheel_left_link"}},
      {"reject_cycle_ur5", {"cycle", "base_link", "tool0"}}};
  for (const auto& [name, parts] : reasons) {
    try {
      read_urdf(kRobots / (name + ".urdf"));
      ADD_FAILURE() << name << " was accepted";
    } catch (const Error& error) {
      for (const std::string& part : parts) EXPECT_THAT(error.what(), HasSubstr(part));
      EXPECT_GT(error.location().line, 0);
    }
  }
}

/// Links one below the other, or all below the first.
std::string tree(int links, bool chain) {
  std::string text = "<link name=\"l0\"/>";
  for (int i = 1; i < links; ++i)
    text += fmt::format(
        "<link name=\"l{0}\"/><joint name=\"j{0}\" type=\"continuous\"><parent link=\"l{1}\"/>"
        "<child link=\"l{0}\"/>{2}</joint>",
        i, chain ? i - 1 : 0, i > 1 ? fmt::format("<mimic joint=\"j{}\"/>", chain ? i - 1 : 1) : "");
  return robot(text);
}

TEST(Urdf, ALongChainTakesNoLongerThanAFlatTree) {
  constexpr int kLinks = 5000;
  const auto seconds = [](bool chain) {
    const std::string text = tree(kLinks, chain);
    const Stopwatch watch;
    EXPECT_EQ(parse_urdf(text, "tree.urdf").links.size(), static_cast<size_t>(kLinks));
    return watch.seconds();
  };
  const double flat = seconds(false);
  EXPECT_LT(seconds(true), 5 * flat + 0.2) << "walking to the root for each link takes minutes";
}

TEST(Urdf, MimickingInACircleIsRefused) {
  std::string text = tree(4, true);
  text.insert(text.find("<child link=\"l1\"/>"), "<mimic joint=\"j3\"/>");
  EXPECT_THAT(message_of(text), HasSubstr("mimics itself"));
}

TEST(Urdf, DepthIsLimited) {
  std::string deep, end;
  for (int i = 0; i < 100000; ++i) deep += "<a>", end += "</a>";
  EXPECT_THAT(message_of(robot("<link name=\"a\">" + deep + end + "</link>")), HasSubstr("depth"));
}

TEST(Urdf, UrdfdomReadsWhatWasChecked) {
  // urdfdom's XML reader ends a declaration at the first '>' where the checker's goes on to "?>".
  std::string hidden = "<?note > ";
  for (int i = 0; i < 100000; ++i) hidden += "<a>";
  const World world = parse_urdf(hidden + "?>" + robot("<link name=\"a\"/>"), "hidden.urdf");
  EXPECT_EQ(world.links.size(), 1U);
}

}  // namespace
}  // namespace loci::mapping
