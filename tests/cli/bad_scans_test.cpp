// Scans that are not what a mapper hopes for: refused, or left out by name, never guessed at.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/sensor/scan.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kSamples = LOCI_SOURCE_DIR "/apps/samples/";

class BadScans : public testing::Test {
 protected:
  void SetUp() override { folder_ = fresh_folder(); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  mapping::ScanSet scans_of(const std::string& world, const std::string& poses) const {
    const std::string out = path("of_" + fs::path(world).stem().string());
    const Outcome outcome =
        run("loci-simulate scan " + world + " --azimuth-step-deg 0.5 --tilt-step-deg 0.5" + " --poses '" +
            poses + "' -o " + out);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return mapping::read_scan_set(out);
  }

  mapping::ScanSet kitchen() const {
    return scans_of(kSamples + "kitchen.urdf", "1,1.5,90; 2,1.5,90; 3,1.5,90; 2,1.5,-90");
  }

  std::string written(const mapping::ScanSet& scans) const {
    write_scan_set(scans, path("scans"));
    return path("scans");
  }

  Outcome interpreted(const mapping::ScanSet& scans) const {
    return run("loci-map interpret " + written(scans) + " -o " + path("map"));
  }

  std::string folder_;
};

void turn_upside_down(mapping::Scan& scan) {
  for (mapping::ScanPoint& point : scan.points) {
    point.position.y() = -point.position.y();
    point.position.z() = -point.position.z();
  }
}

void empty(mapping::Scan& scan) {
  for (mapping::ScanPoint& point : scan.points) point.returned = false;
}

TEST_F(BadScans, OfTwoDifferentRoomsAreNotBroughtTogether) {
  mapping::ScanSet scans = scans_of(kSamples + "kitchen.urdf", "2,1.5,90");
  scans.scans.push_back(scans_of(kSamples + "kitchen_l.urdf", "2,1.2,90").scans.front());
  scans.scans.back().name = "elsewhere";
  scans.scans.back().map_from_scan = scans.scans.front().map_from_scan;
  const Outcome outcome = run("loci-map register " + written(scans) + " -o " + path("registered"));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("refused"));
  EXPECT_THAT(outcome.error, HasSubstr("different places"));
  EXPECT_FALSE(fs::exists(path("registered")));
}

TEST_F(BadScans, OfAnotherRoomIsLeftOutOfTheRest) {
  mapping::ScanSet scans = scans_of(kSamples + "kitchen.urdf", "1.5,1.5,90; 2,1.5,90");
  scans.scans.push_back(scans_of(kSamples + "kitchen_l.urdf", "2,1.2,90").scans.front());
  scans.scans.back().name = "elsewhere";
  scans.scans.back().map_from_scan = scans.scans.front().map_from_scan;
  const Outcome outcome = run("loci-map register " + written(scans) + " -o " + path("registered"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(mapping::read_scan_set(path("registered")).scans.size(), 2U);
}

TEST_F(BadScans, OneWithoutReturnsIsNamedAndChangesNothing) {
  mapping::ScanSet scans = kitchen();
  scans.scans.push_back(scans.scans.front());
  scans.scans.back().name = "blind";
  empty(scans.scans.back());
  const Outcome outcome = interpreted(scans);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("blind"));
  EXPECT_THAT(outcome.out, HasSubstr("4 walls"));
  const Outcome registered = run("loci-map register " + path("scans") + " -o " + path("registered"));
  EXPECT_EQ(registered.exit_code, 0) << registered.error;
  // Nothing ties the one that looks south to the others either.
  EXPECT_EQ(mapping::read_scan_set(path("registered")).scans.size(), 3U);
}

TEST_F(BadScans, AllWithoutReturnsAreRefused) {
  mapping::ScanSet scans = scans_of(kSamples + "kitchen.urdf", "2,1.5,90");
  empty(scans.scans.front());
  const Outcome outcome = interpreted(scans);
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_FALSE(fs::exists(path("map/map.urdf")));
}

TEST_F(BadScans, ASecondInputThatIsNotThereIsNamedBeforeTheWork) {
  mapping::ScanSet scans = scans_of(kSamples + "kitchen.urdf", "2,1.5,90");
  empty(scans.scans.front());  // the work would fail
  const std::string command = "loci-map interpret " + written(scans) + " -o " + path("map");
  for (const std::string option : {" --recording ", " --names-from "}) {
    const Outcome outcome = run(command + option + path("nope"));
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_THAT(outcome.error, HasSubstr("nope"));
  }
}

TEST_F(BadScans, OneThatStandsOnItsHeadIsLeftOutAndAllOfThemAreRefused) {
  mapping::ScanSet scans = kitchen();
  turn_upside_down(scans.scans[1]);
  const Outcome outcome = interpreted(scans);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("upside down"));
  for (const size_t i : {0, 2, 3}) turn_upside_down(scans.scans[i]);
  const Outcome refused = run("loci-map interpret " + written(scans) + " -o " + path("none"));
  EXPECT_EQ(refused.exit_code, 1) << refused.out;
  EXPECT_EQ(lines_of(refused.error), 1) << refused.error;
  EXPECT_THAT(refused.error, HasSubstr("upside down"));
}

TEST_F(BadScans, CutOffFileIsNamed) {
  const std::string scans = written(scans_of(kSamples + "kitchen.urdf", "2,1.5,90"));
  for (const auto& entry : fs::directory_iterator(scans))
    if (entry.path().extension() == ".pcd") fs::resize_file(entry.path(), fs::file_size(entry.path()) / 2);
  for (const std::string command : {"interpret", "register"}) {
    const Outcome outcome = run("loci-map " + command + " " + scans + " -o " + path("out"));
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr(".pcd"));
    EXPECT_FALSE(fs::exists(path("out")));
  }
}

/// A box that is open above: a floor and four walls.
std::string empty_room() {
  const auto link = [](const std::string& name, const std::string& size, const std::string& at) {
    return "<link name=\"" + name + "\"><visual><geometry><box size=\"" + size +
           "\"/></geometry></visual></link><joint name=\"" + name + "_joint\" type=\"fixed\"><origin xyz=\"" +
           at + "\"/><parent link=\"map\"/><child link=\"" + name + "\"/></joint>";
  };
  return "<robot name=\"room\"><link name=\"map\"/>" + link("floor", "4 3 0.1", "2 1.5 -0.05") +
         link("west", "0.1 3 2.5", "-0.05 1.5 1.25") + link("east", "0.1 3 2.5", "4.05 1.5 1.25") +
         link("south", "4 0.1 2.5", "2 -0.05 1.25") + link("north", "4 0.1 2.5", "2 3.05 1.25") + "</robot>";
}

TEST_F(BadScans, RoomWithoutFurnitureIsAMapOfFloorAndWalls) {
  write_file_atomically(path("room.urdf"), empty_room());
  const Outcome outcome =
      run("loci-map explore " + path("room.urdf") + " --interact --json -o " + path("explored"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_TRUE(Json::parse(outcome.out)["interactions"].empty());
  EXPECT_EQ(run("loci-map check " + path("explored/map.urdf")).exit_code, 0);
  const Json sidecar = Json::parse(read_file(path("explored/map.semantic.json")));
  std::map<std::string, int> classes;
  for (const auto& [name, link] : sidecar.at("links").items()) ++classes[link.at("class")];
  const std::map<std::string, int> expected = {{"floor", 1}, {"wall", 4}};
  EXPECT_EQ(classes, expected);
}

}  // namespace
}  // namespace loci::apps::test
