// A run that finds nothing says why, and fails when fewer than a tenth of the frames could be used.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/support/box_table.h"

namespace loci::apps::test {
namespace {

using loci::test::BoxTable;
using loci::test::table_camera;

class SilentNothing : public testing::Test {
 protected:
  /// Writes a recording of views; `given` is what it says about the poses.
  std::string record(const std::function<BoxTable(int64_t)>& view_of,
                     const std::function<std::optional<Isometry3d>(int64_t)>& given, int64_t frames = 3) {
    loci::test::record_table(folder_ + "/recording", frames, view_of, given);
    return folder_ + "/recording";
  }

  static std::optional<Isometry3d> no_pose(int64_t) { return std::nullopt; }

  std::string folder_ = fresh_folder();
};

TEST_F(SilentNothing, HandHeldCameraWithoutPosesSaysWhy) {
  // Each frame shows the boxes somewhere else, and nobody says that the camera moves.
  const auto view = [](int64_t i) { return BoxTable{table_camera(0.11 * static_cast<double>(i * i % 7))}; };
  const Outcome outcome =
      run("loci-perceive run " + record(view, no_pose, 10) + " -m " + folder_ + "/m.loci --json");
  const Json used = parse_json(outcome.out, "run")["frames_used"];
  EXPECT_EQ(used["total"], 10);
  EXPECT_GT(used["reasons"]["unconfirmed"], 2) << used;
  EXPECT_EQ(outcome.exit_code, used["used"] == 0 ? 1 : 0);
}

TEST_F(SilentNothing, WallAloneNamesThePlane) {
  const auto view = [](int64_t) { return BoxTable{table_camera(0, 0, 0), -1}; };
  const auto pose = [&](int64_t i) { return std::optional(view(i).map_from_camera); };
  const Outcome outcome = run("loci-perceive run " + record(view, pose));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("no object found in 3 frames: no supporting plane in 3; show a table"),
            std::string::npos)
      << outcome.error;
}

TEST_F(SilentNothing, PipelineThatLooksForNothingIsNoFailure) {
  const auto view = [](int64_t) { return BoxTable{table_camera(0, 0, 0), -1}; };
  const auto pose = [&](int64_t i) { return std::optional(view(i).map_from_camera); };
  write_file_atomically(folder_ + "/pipeline.yaml", "flow: [NormalEstimator]\n");
  const Outcome outcome =
      run("loci-perceive run " + record(view, pose) + " --pipeline " + folder_ + "/pipeline.yaml");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("nothing detected in 3"), std::string::npos) << outcome.error;
}

TEST_F(SilentNothing, EmptyTableIsNoFailure) {
  const auto view = [](int64_t) {
    BoxTable table{table_camera(0.15)};
    table.map_from_camera.translation().y() = 2;  // The boxes lie behind.
    table.wall_m = 4;
    return table;
  };
  const auto pose = [&](int64_t i) { return std::optional(view(i).map_from_camera); };
  const Outcome outcome = run("loci-perceive run " + record(view, pose) + " --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("nothing on the supports in 3"), std::string::npos) << outcome.error;
  EXPECT_EQ(parse_json(outcome.out, "run")["frames_used"]["reasons"]["support_empty"], 3);
}

TEST_F(SilentNothing, WorldWithYDownIsNamed) {
  const auto view = [](int64_t) { return BoxTable{table_camera(0, 35, 0), 0.7}; };
  const auto pose = [&](int64_t i) {
    Isometry3d down_from_map = Isometry3d::Identity();
    down_from_map.linear() = Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()).toRotationMatrix();
    return std::optional(Isometry3d(down_from_map * view(i).map_from_camera));
  };
  const Outcome outcome = run("loci-perceive run " + record(view, pose));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("a plane that is not level in the frame of the poses in 3"), std::string::npos)
      << outcome.error;
  EXPECT_NE(outcome.error.find("world_to_map.txt"), std::string::npos) << outcome.error;
}

TEST_F(SilentNothing, CameraOnItsSideWithoutPosesFindsTheObjects) {
  for (const double roll_deg : {90.0, 180.0, 270.0}) {
    const auto view = [&](int64_t) { return BoxTable{table_camera(0, 35, roll_deg), 0.7, 5}; };
    const Outcome outcome = run("loci-perceive run " + record(view, no_pose) + " --json");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(parse_json(outcome.out, "run")["frames_used"]["used"], 3) << outcome.out;
  }
}

TEST_F(SilentNothing, WrongDepthUnitIsNamed) {
  const auto view = [](int64_t) { return BoxTable{table_camera(0, 0, 0), -1, 20}; };
  const auto pose = [&](int64_t i) { return std::optional(view(i).map_from_camera); };
  const Outcome outcome = run("loci-perceive run " + record(view, pose));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("no depth between 0.2 and 5 m in 3; check depth_scale"), std::string::npos)
      << outcome.error;
}

TEST_F(SilentNothing, FramesOutsideTheMapAreNamed) {
  const auto view = [](int64_t) { return BoxTable{table_camera(0, 35, 0), 0.7}; };
  const auto pose = [&](int64_t i) {
    Isometry3d far = view(i).map_from_camera;
    far.translation() += Vector3d(500, 500, 0);
    return std::optional(far);
  };
  const Outcome outcome = run("loci-perceive run " + record(view, pose) + " --map apps/samples/kitchen.urdf");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("nothing of the map in view in 3"), std::string::npos) << outcome.error;
}

TEST_F(SilentNothing, AMemoryOfNothingSaysHowToTryAgain) {
  const auto view = [](int64_t) { return BoxTable{table_camera(0, 0, 0), -1}; };
  const auto pose = [&](int64_t i) { return std::optional(view(i).map_from_camera); };
  const std::string command =
      "loci-perceive run " + record(view, pose) + " --quiet -m " + folder_ + "/m.loci";
  for (const Outcome& outcome : {run(command), run(command)}) {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.error.find("to perceive it anew, remove " + folder_ + "/m.loci"), std::string::npos)
        << outcome.error;
    EXPECT_EQ(outcome.error.find("--resume"), std::string::npos) << outcome.error;
  }
}

TEST_F(SilentNothing, FuseOfFewReadableFramesFailsAndWritesNothing) {
  const auto view = [](int64_t i) { return BoxTable{table_camera(0.02 * static_cast<double>(i))}; };
  const auto pose = [&](int64_t i) { return std::optional(view(i).map_from_camera); };
  const std::string recording = record(view, pose, 20), scans = folder_ + "/scans";
  const auto spoil = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      const std::string file = fmt::format("{}/frames/{:06}_depth.png", recording, i);
      write_file_atomically(file, read_file(file).substr(0, 100));
    }
  };
  spoil(0, 10);
  const std::string command = "loci-map fuse " + recording + " -o " + scans + " --mesh-voxel-m 0";
  const Outcome half = run(command);
  EXPECT_EQ(half.exit_code, 0) << half.error;
  EXPECT_NE(half.out.find("10 frames became 1 scan"), std::string::npos) << half.out;
  EXPECT_NE(half.out.find("left out: an image that cannot be read in 10"), std::string::npos) << half.out;
  std::filesystem::remove_all(scans);
  spoil(10, 19);
  const Outcome few = run(command);
  EXPECT_EQ(few.exit_code, 1);
  EXPECT_NE(few.error.find("only 1 of 20 frames could be used: an image that cannot be read in 19 ("),
            std::string::npos)
      << few.error;
  EXPECT_NE(few.error.find("; copy or record these files again"), std::string::npos) << few.error;
  EXPECT_FALSE(std::filesystem::exists(scans + "/scans.yaml"));
}

TEST(SilentNothingReal, ABinWithoutASupportIsSeenAllTheSame) {
  LOCI_NEEDS_SHARED("data/shelf_bin");
  const Outcome outcome = run("loci-perceive run " + shared("data/shelf_bin"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.error.find("no object found"), std::string::npos) << outcome.error;
}

}  // namespace
}  // namespace loci::apps::test
