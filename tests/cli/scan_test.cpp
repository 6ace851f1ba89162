#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/sensor/scan.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kScan = "loci-simulate scan " LOCI_SOURCE_DIR "/apps/samples/kitchen_l.urdf ";
/// A sweep of few rays.
const std::string kCoarse = " --azimuth-step-deg 2 --tilt-step-deg 2 ";

TEST(ScanCommand, WritesAScanSetWithTruePoses) {
  const std::string folder = fresh_folder() + "/scans";
  const Outcome outcome = run(kScan + kCoarse + "--poses '2,1.2,90; 3,3,180' --json -o " + folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(Json::parse(outcome.out)["scans"].size(), 2u);
  const mapping::ScanSet set = mapping::read_scan_set(folder);
  EXPECT_EQ(set.sensor, "hokuyo");
  EXPECT_TRUE(set.levelled);
  EXPECT_TRUE(set.free_space);
  ASSERT_EQ(set.scans.size(), 2u);
  EXPECT_LT((set.scans[1].map_from_scan.translation() - Vector3d(3, 3, 1.25)).norm(), 1e-9);
  EXPECT_TRUE(set.scans[1].covariance.isZero(0));
  EXPECT_EQ(set.scans[0].points.size(), 91u * 48u);
}

TEST(ScanCommand, OdometryDriftsFromTheTruthThatStandsBeside) {
  const std::string folder = fresh_folder();
  const std::string command = kScan + kCoarse + "--poses '2,1.2,90; 3,3,180' --odometry --seed 4 -o ";
  ASSERT_EQ(run(command + folder + "/a").exit_code, 0);
  ASSERT_EQ(run(command + folder + "/b --threads 1").exit_code, 0);
  for (const char* file : {"scans.yaml", "scan_000.pcd", "scan_001.pcd", "truth.jsonl"})
    EXPECT_EQ(read_file(folder + "/a/" + file), read_file(folder + "/b/" + file)) << file;
  const mapping::ScanSet set = mapping::read_scan_set(folder + "/a");
  EXPECT_GT(set.scans[1].covariance(0, 0), 0);
  const std::string truth = read_file(folder + "/a/truth.jsonl");
  const Json second = Json::parse(truth.substr(truth.find('\n') + 1));
  EXPECT_EQ(second["scan"], "scan_001");
  const double off = std::hypot(second["pose"][0].get<double>() - 3, second["pose"][1].get<double>() - 3);
  EXPECT_GT(off, 1e-4);
  EXPECT_LT(off, 6 * std::sqrt(set.scans[1].covariance(0, 0) + set.scans[1].covariance(1, 1)));
}

TEST(ScanCommand, OpenJointIsSeen) {
  const std::string folder = fresh_folder();
  const std::string command = kScan + kCoarse + "--poses '2.8,1.5,180' -o ";
  ASSERT_EQ(run(command + folder + "/a").exit_code, 0);
  ASSERT_EQ(run(command + folder + "/b --joints drawer_1_front_joint=0.4 door_1_joint=1.5").exit_code, 0);
  EXPECT_NE(read_file(folder + "/a/scan_000.pcd"), read_file(folder + "/b/scan_000.pcd"));
}

TEST(ScanCommand, RefusesWhatItCannotDo) {
  const std::string out = " -o " + fresh_folder() + "/scans";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"--poses '2,1'", "no pose"},
      {"--poses '2,1,x'", "no pose"},
      {"--poses ' ; '", "names no pose"},
      {"--poses '2,3,0'", "island_1"},
      {"--poses '2,1.2,0' --joints drawer_1_front_jont=0.2", "drawer_1_front_joint"},
      {"--poses '2,1.2,0' --joints drawer_1_front_joint=2", "0.42"},
      {"--poses '2,1.2,0' --joints drawer_1_front_joint", "joint=value"},
      {"--poses '2,1.2,0' --floor low", "'low' is not the height of a floor"}};
  for (const auto& [arguments, says] : cases) {
    const Outcome outcome = run(kScan + arguments + out);
    EXPECT_EQ(outcome.exit_code, 1) << arguments;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr(says)) << arguments;
  }
  EXPECT_EQ(run("loci-simulate scan none.urdf --poses '0,0,0'" + out).exit_code, 1);
  const Outcome usage = run(kScan + "--poses '2,1.2,0' --tilt-step-deg low" + out);
  EXPECT_EQ(usage.exit_code, 2);
  EXPECT_THAT(usage.error, HasSubstr("'low' is not a number"));
  const Outcome out_of_range = run(kScan + "--poses '2,1.2,0' --tilt-step-deg 0" + out);
  EXPECT_EQ(out_of_range.exit_code, 2);
  EXPECT_THAT(out_of_range.error, HasSubstr("--tilt-step-deg: 0 is not allowed (0.01 to 10)"));
}

}  // namespace
}  // namespace loci::apps::test
