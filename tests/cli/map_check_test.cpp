#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

using testing::HasSubstr;

constexpr const char* kCupboard =
    "<robot name=\"cupboard\"><link name=\"body\"><inertial><mass value=\"2\"/>"
    "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"
    "<visual><geometry><box size=\"1 2 3\"/></geometry></visual></link><link name=\"door\"><visual><geometry>"
    "<mesh filename=\"door.stl\"/></geometry></visual></link><joint name=\"hinge\" type=\"continuous\">"
    "<parent link=\"body\"/><child link=\"door\"/></joint><gazebo/></robot>";

TEST(MapCheck, SaysWhatAFileHolds) {
  const std::string folder = fresh_folder();
  write_file_atomically(folder + "/cupboard.urdf", kCupboard);
  write_file_atomically(
      folder + "/cupboard.semantic.json",
      R"({"version": 1, "links": {"body": {"class": "cabinet"}, "dor": {"class": "door"}}})");
  const Outcome outcome = run("loci-map check " + folder + "/cupboard.urdf --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json json = parse_json(outcome.out, "stdout");
  EXPECT_EQ(json["links"], 2);
  EXPECT_EQ(json["joints_by_type"]["continuous"], 1);
  EXPECT_EQ(json["triangles"], 12);
  EXPECT_EQ(json["mass_kg"], 2);
  EXPECT_EQ(json["bounds"]["max"], Json({0.5, 1.0, 1.5}));
  EXPECT_EQ(json["extensions"]["gazebo"], 1);
  EXPECT_EQ(json["classes"]["cabinet"], 1);
  EXPECT_EQ(json["missing_meshes"], Json({"door.stl"}));
  EXPECT_THAT(outcome.error, HasSubstr("mesh 'door.stl' not found"));
  EXPECT_THAT(outcome.error, HasSubstr("did you mean 'door'?"));
}

TEST(MapCheck, RefusesInOneLine) {
  const std::string folder = fresh_folder();
  write_file_atomically(folder + "/bad.urdf",
                        "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"a\"/></robot>");
  for (const std::string& file : {folder + "/bad.urdf", folder + "/missing.urdf", folder}) {
    const Outcome outcome = run("loci-map check " + file);
    EXPECT_EQ(outcome.exit_code, 1) << file;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr(file));
  }
}

TEST(MapCheck, LoadsTheApartmentWithAllItsMeshes) {
  LOCI_NEEDS_SHARED("data/iai_apartment");
  const Outcome outcome = run("loci-map check " + shared("data/iai_apartment/apartment.urdf") +
                              " --json --package-path " + shared("data"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.error, "");
  const Json json = parse_json(outcome.out, "stdout");
  EXPECT_EQ(json["links"], 117);
  EXPECT_TRUE(json["missing_meshes"].empty());
}

TEST(MapCheck, LoadsOrRefusesEveryRobot) {
  LOCI_NEEDS_SHARED("data/robots");
  for (const char* name :
       {"pr2", "turtlebot2", "turtlebot3_burger", "panda", "ur5", "fetch", "iiwa14_primitive_collision"})
    EXPECT_EQ(run("loci-map check " + shared(std::string("data/robots/") + name + ".urdf")).exit_code, 0)
        << name;
  for (const char* name :
       {"pr2_simplified", "spot_arm", "r2_left_gripper", "two_roots_turtlebot3_burger", "cycle_ur5"}) {
    const Outcome outcome =
        run("loci-map check " + shared(std::string("data/robots/reject_") + name + ".urdf"));
    EXPECT_EQ(outcome.exit_code, 1) << name;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
  }
}

}  // namespace
}  // namespace loci::apps::test
