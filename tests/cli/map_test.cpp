// From a recording to a map, as a user would go.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "mapping/base/files.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Span {
  double min = 1e9, max = -1e9;
  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

/// A fact of known_facts.csv: value and tolerance.
void expect_fact(const CsvTable& facts, const std::string& name, double value) {
  for (size_t row = 0; row < facts.rows(); ++row)
    if (facts.cell(row, facts.require_column("name")) == name) {
      const double truth = facts.number(row, facts.require_column("value"));
      EXPECT_NEAR(value, truth, facts.number(row, facts.require_column("tolerance"))) << name;
      return;
    }
  ADD_FAILURE() << "no fact " << name;
}

TEST(MapCommands, RealKitchenMeetsItsKnownFacts) {
  const std::string recording = shared("data/redkitchen_rgbd");
  if (recording.empty()) GTEST_SKIP() << "no shared data";
  const std::string folder = fresh_folder();
  Outcome outcome = run("loci-map fuse " + recording + " -o " + folder + "/scans --quiet");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  outcome = run("loci-map interpret " + folder + "/scans -o " + folder + "/map --quiet");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_TRUE(fs::exists(folder + "/map/report.html"));
  const CsvTable facts = CsvTable::read(recording + "/known_facts.csv");
  const Json links = read_json(folder + "/map/map.semantic.json").at("links");
  expect_fact(facts, "floor_z", links.at("floor").at("geometry").at("height"));
  expect_fact(facts, "table_top_z", links.at("table_1").at("geometry").at("height"));
  Span x, y;
  for (const Json& corner : links.at("table_1").at("geometry").at("outline")) {
    x.add(corner.at(0));
    y.add(corner.at(1));
  }
  expect_fact(facts, "table_x_min", x.min);
  expect_fact(facts, "table_x_max", x.max);
  expect_fact(facts, "table_y_min", y.min);
  expect_fact(facts, "table_y_max", y.max);
  expect_fact(facts, "back_counter_top_z", links.at("counter_1").at("geometry").at("height"));
  expect_fact(facts, "left_counter_top_z", links.at("counter_2").at("geometry").at("height"));
  expect_fact(facts, "red_wall_shelf_z", links.at("shelf_1").at("geometry").at("height"));
  // normal · p = offset, at the places that the facts name.
  const auto on_wall = [&](const std::string& name, int axis, double other) {
    const Json& wall = links.at(name).at("geometry");
    const double a = wall.at("normal").at(static_cast<size_t>(axis));
    const double b = wall.at("normal").at(static_cast<size_t>(1 - axis));
    return (wall.at("offset").get<double>() - b * other) / a;
  };
  expect_fact(facts, "back_wall_y", on_wall("wall_north", 1, 1.0));
  expect_fact(facts, "left_wall_x_at_y1.8", on_wall("wall_west", 0, 1.8));
}

TEST(MapCommands, InterpretRefusesBadInputInOneLineAndWritesNothing) {
  const std::string folder = fresh_folder();
  fs::create_directories(folder + "/empty");
  write_file_atomically(
      folder + "/cut.pcd",
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100\n"
      "HEIGHT 1\nPOINTS 100\nDATA binary\nxxxx");
  for (const std::string input : {"/missing", "/empty", "/cut.pcd"}) {
    const Outcome outcome = run("loci-map interpret " + folder + input + " -o " + folder + "/map");
    EXPECT_EQ(outcome.exit_code, 1) << input;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_FALSE(fs::exists(folder + "/map")) << input;
  }
}

TEST(MapCommands, CompareOfAMapWithItselfIsPerfect) {
  const Outcome outcome = run("loci-map compare apps/samples/kitchen.urdf apps/samples/kitchen.urdf --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json json = parse_json(outcome.out, "stdout");
  EXPECT_EQ(json.at("supports").at("recall"), 1);
  EXPECT_EQ(json.at("supports").at("precision"), 1);
  EXPECT_EQ(json.at("walls").at("matched"), 4);
}

TEST(MapCommands, ExportedSdfNamesMeshesFromItsOwnFolder) {
  const std::string folder = fresh_folder();
  fs::create_directories(folder + "/map/textures");
  fs::create_directories(folder + "/sdf");
  write_file_atomically(folder + "/map/map.urdf",
                        "<robot name=\"m\"><link name=\"map\"><visual><geometry><mesh "
                        "filename=\"textures/door_1.obj\"/></geometry></visual></link></robot>");
  const Outcome outcome = run("loci-map export " + folder + "/map/map.urdf -o " + folder + "/sdf/map.sdf");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(read_file(folder + "/sdf/map.sdf"), HasSubstr("<uri>../map/textures/door_1.obj</uri>"));
}

/// The sample kitchen with a photo on a door: map.urdf, its sidecar and textures/ in the folder.
void write_textured_kitchen(const fs::path& folder) {
  const fs::path samples = fs::path(LOCI_SOURCE_DIR) / "apps/samples";
  fs::create_directories(folder / "textures");
  std::string urdf = read_file(samples / "kitchen.urdf");
  const std::string door = "<link name=\"door_1\">", end = "</link>";
  const size_t at = urdf.find(end, urdf.find(door));
  urdf.insert(
      at, "<visual name=\"photo\"><geometry><mesh filename=\"textures/door_1.obj\"/></geometry></visual>");
  write_file_atomically(folder / "map.urdf", urdf);
  fs::copy_file(samples / "kitchen.semantic.json", folder / "map.semantic.json");
  write_file_atomically(folder / "textures/door_1.obj",
                        "mtllib textures.mtl\nv 0 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
                        "usemtl door_1\nf 1/1 2/2 3/3\n");
  write_file_atomically(folder / "textures/textures.mtl", "newmtl door_1\nmap_Kd door_1.jpg\n");
  mapping::write_image(folder / "textures/door_1.jpg", cv::Mat(40, 30, CV_8UC3, cv::Scalar(10, 20, 200)));
}

TEST(MapCommands, UpdateKeepsTexturesAndShowsThem) {
  const std::string folder = fresh_folder();
  write_textured_kitchen(folder + "/map");
  Outcome outcome = run("loci-simulate scan " LOCI_SOURCE_DIR
                        "/apps/samples/kitchen.urdf --azimuth-step-deg 1 --tilt-step-deg 1 --poses "
                        "'1.5,1.5,90; 2.5,1.5,180' -o " +
                        folder + "/scans");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  outcome = run("loci-map update " + folder + "/map/map.urdf " + folder + "/scans --scans-before " + folder +
                "/scans -o " + folder + "/updated");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* file : {"door_1.obj", "door_1.jpg", "textures.mtl"})
    EXPECT_EQ(read_file(folder + "/updated/textures/" + file), read_file(folder + "/map/textures/" + file));
  EXPECT_THAT(read_file(folder + "/updated/map.urdf"), HasSubstr("textures/door_1.obj"));
  const std::string report = read_file(folder + "/updated/report.html");
  EXPECT_THAT(report, HasSubstr("<canvas"));
  EXPECT_THAT(report, HasSubstr("data:image/jpeg")) << "the elevation is drawn over the photo";
}

TEST(MapCommands, ScansCannotBeExportedAsGlb) {
  const std::string folder = fresh_folder();
  write_file_atomically(
      folder + "/one.pcd",
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
      "HEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n");
  const Outcome outcome = run("loci-map export " + folder + "/one.pcd -o " + folder + "/one.glb");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("export the map for glb"));
  EXPECT_FALSE(fs::exists(folder + "/one.glb"));
}

}  // namespace
}  // namespace loci::apps::test
