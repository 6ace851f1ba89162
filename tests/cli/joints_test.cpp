// Drawers whose joints nobody names: fitted by their fronts, on a simulated recording with the sensor's
// noise.

#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;

/// Records a scenario in the sample kitchen without joint states: nobody says what is open.
void record(const std::string& folder, const std::string& scenes) {
  write_file_atomically(fs::path(folder) / "drawer.yaml",
                        "world: " LOCI_SOURCE_DIR "/apps/samples/kitchen.urdf\nscenes:" + scenes);
  ASSERT_EQ(run("loci-simulate record " + folder + "/drawer.yaml --quiet -o " + folder + "/drawer").exit_code,
            0);
  fs::remove(folder + "/drawer/joints.csv");
}

TEST(Joints, OfOpenDrawersAreAnnotationsOfTheScene) {
  const std::string folder = fresh_folder();
  record(folder, R"(
  - time: "2026-05-01T08:05:00Z"
    view: {from: [1.62, 1.0, 1.50], at: [1.60, 2.20, 0.72]}
    do:
      - {open: drawer_2, to: 0.42}
)");
  const std::string memory = folder + "/memory.loci";
  const Outcome outcome =
      run("loci-perceive run " + folder +
          "/drawer --json --quiet --map " LOCI_SOURCE_DIR "/apps/samples/kitchen.urdf -m " + memory);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json answer = parse_json(outcome.out, "run");
  int moved = 0;
  for (const Json& each : answer["scenes"][0]["annotations"]) {
    if (each["type"] != "JointAnnotation" || !each["moved"].get<bool>()) continue;
    ++moved;
    EXPECT_EQ(each["joint"], "drawer_2_front_joint");
    EXPECT_NEAR(each["position"].get<double>(), 0.42, 0.015);
    EXPECT_GT(each["confidence"].get<double>(), 0.25);
  }
  EXPECT_EQ(moved, 1) << answer["scenes"][0]["annotations"];
  const Json size = parse_json(run("loci-memory stat --json -m " + memory).out, "stat");
  EXPECT_EQ(size["tables"]["scene"]["rows"], 1);
}

TEST(Joints, ADrawerThatIsShutAgainIsSeenToBeShut) {
  const std::string folder = fresh_folder();
  record(folder, R"(
  - time: "2026-05-01T08:00:00Z"
    view: {from: [1.62, 1.0, 1.50], at: [1.60, 2.20, 0.72]}
  - time: "2026-05-01T08:05:00Z"
    view: {from: [1.62, 1.0, 1.50], at: [1.60, 2.20, 0.72]}
    do:
      - {open: drawer_2, to: 0.42}
  - time: "2026-05-01T08:10:00Z"
    view: {from: [1.62, 1.0, 1.50], at: [1.60, 2.20, 0.72]}
    do:
      - {close: drawer_2}
)");
  const std::string memory = folder + "/memory.loci";
  ASSERT_EQ(run("loci-perceive run " + folder +
                "/drawer --quiet --map " LOCI_SOURCE_DIR "/apps/samples/kitchen.urdf -m " + memory)
                .exit_code,
            0);
  const std::string answer = run("loci-memory ask 'Is drawer_2 open?' -m " + memory).out;
  EXPECT_EQ(answer.substr(0, answer.find('\n')), "No: drawer_2 is closed, as of 08:10.");
}

TEST(Joints, ThatTheMapLacksAreSaidOnce) {
  const std::string folder = fresh_folder();
  record(folder, R"(
  - time: "2026-05-01T08:00:00Z"
    view: {from: [1.62, 1.0, 1.50], at: [1.60, 2.20, 0.72]}
  - time: "2026-05-01T08:05:00Z"
    view: {from: [1.62, 1.0, 1.50], at: [1.60, 2.20, 0.72]}
)");
  write_file_atomically(
      fs::path(folder) / "drawer/joints.csv",
      "time_ns,joint,position\n1777622400000000000,flap_9,0\n1777622700000000000,flap_9,0\n");
  const std::string said =
      run("loci-perceive run " + folder + "/drawer --map " LOCI_SOURCE_DIR "/apps/samples/kitchen.urdf")
          .error;
  const size_t first =
      said.find("the map has no joint 'flap_9', which the recording moves: it is left out (2 times)");
  ASSERT_NE(first, std::string::npos) << said;
  EXPECT_EQ(said.find("flap_9", said.find("flap_9") + 1), std::string::npos) << said;
}

}  // namespace
}  // namespace loci::apps::test
