#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <opencv2/core.hpp>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kScenario = R"(world: kitchen.urdf
objects: {cup: {model: mug, color: [0.8, 0.1, 0.1]}}
scenes:
  - time: "2026-05-01T07:00:00Z"
    view: {from: [1.6, 1.3, 1.4], at: [1.6, 2.7, 0.9]}
    do: [{place: cup, on: counter_1}]
)";

/// A folder with the sample kitchen and a scenario of one frame.
std::string scenario_folder(const std::string& scenario = kScenario) {
  const std::string folder = fresh_folder();
  fs::copy_file(fs::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf", folder + "/kitchen.urdf");
  write_file_atomically(folder + "/s.yaml", scenario);
  return folder;
}

void expect_one_line_refusal(const Outcome& outcome, const std::string& text) {
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr(text));
}

TEST(RecordAndInfo, RecordedScenarioIsDescribed) {
  const std::string folder = scenario_folder();
  const Outcome recorded =
      run("loci-simulate record " + folder + "/s.yaml -o " + folder + "/rec --seed 3 --json");
  EXPECT_EQ(recorded.exit_code, 0) << recorded.error;
  EXPECT_EQ(parse_json(recorded.out, "stdout")["frames"], 1);
  const Outcome info = run("loci-perceive info " + folder + "/rec --json");
  EXPECT_EQ(info.exit_code, 0) << info.error;
  const Json json = parse_json(info.out, "stdout");
  EXPECT_EQ(json["format"], "loci");
  EXPECT_EQ(json["frames"], 1);
  EXPECT_EQ(json["frames_with_pose"], 1);
  EXPECT_EQ(json["first_time"], "2026-05-01T07:00:00Z");
  EXPECT_THAT(json["problems"], IsEmpty());
}

TEST(RecordAndInfo, InfoSaysWhatWasGuessed) {
  LOCI_NEEDS_SHARED("data/redkitchen_rgbd");
  const Outcome info = run("loci-perceive info " + shared("data/redkitchen_rgbd/frames"));
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_THAT(info.out, HasSubstr("160 frames, layout 7-scenes"));
  EXPECT_THAT(info.out, HasSubstr("(made up)"));
  EXPECT_THAT(info.out, HasSubstr("guessed no time stamps"));
}

TEST(RecordAndInfo, BadRecordingsAreRefusedInOneLine) {
  const std::string folder = scenario_folder();
  expect_one_line_refusal(run("loci-perceive info " + folder + "/nowhere"), "no such recording");
  fs::create_directories(folder + "/empty");
  expect_one_line_refusal(run("loci-perceive info " + folder + "/empty"), "the folder is empty");
  ASSERT_EQ(run("loci-simulate record " + folder + "/s.yaml -o " + folder + "/rec").exit_code, 0);
  const std::string depth = folder + "/rec/frames/000000_depth.png";
  fs::resize_file(depth, fs::file_size(depth) / 2);
  expect_one_line_refusal(run("loci-perceive info " + folder + "/rec"),
                          "000000_depth.png: the image is truncated");
}

TEST(RecordAndInfo, BadScenarioLeavesTheOldRecording) {
  const std::string folder = scenario_folder();
  const std::string command = "loci-simulate record " + folder + "/s.yaml -o " + folder + "/rec";
  ASSERT_EQ(run(command).exit_code, 0);
  const std::string before = read_file(folder + "/rec/frames.csv");
  std::string scenario = kScenario;
  scenario.replace(scenario.find("on: counter_1"), 13, "on: countr_1");
  write_file_atomically(folder + "/s.yaml", scenario);
  expect_one_line_refusal(run(command), "unknown link 'countr_1'; did you mean 'counter_1'?");
  EXPECT_EQ(read_file(folder + "/rec/frames.csv"), before);
  write_file_atomically(folder + "/s.yaml", std::string("wrld: kitchen.urdf\n"));
  expect_one_line_refusal(run(command), "s.yaml:1: unknown key 'wrld'; did you mean 'world'?");
  expect_one_line_refusal(run("loci-simulate record " + folder + "/absent.yaml -o " + folder + "/rec"),
                          "no such file");
  fs::remove(folder + "/kitchen.urdf");
  write_file_atomically(folder + "/s.yaml", std::string(kScenario));
  expect_one_line_refusal(run(command), "kitchen.urdf");
}

TEST(RecordAndInfo, RecordDoesNotWriteIntoAFolderOfOtherThings) {
  const std::string folder = scenario_folder();
  expect_one_line_refusal(run("loci-simulate record " + folder + "/s.yaml -o " + folder),
                          "loci did not write it");
  EXPECT_TRUE(fs::exists(folder + "/s.yaml"));
}

/// Frames of a hand-held camera as if it had been turned by a quarter `quarters` times, without poses.
std::string hand_held(int quarters) {
  const auto recording = mapping::open_recording(shared("data/redkitchen_30hz/frames"));
  const std::array<cv::RotateFlags, 3> turns = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                                cv::ROTATE_90_COUNTERCLOCKWISE};
  const auto turned = [&](mapping::PinholeCamera c) {
    if (quarters == 2)
      return mapping::PinholeCamera{c.width, c.height, c.fx, c.fy, c.width - 1 - c.cx, c.height - 1 - c.cy};
    if (quarters == 0) return c;
    const bool right = quarters == 1;
    return mapping::PinholeCamera{
        c.height, c.width, c.fy, c.fx, right ? c.height - 1 - c.cy : c.cy, right ? c.cx : c.width - 1 - c.cx};
  };
  mapping::RgbdCamera camera = recording->info().camera;
  const Isometry3d turn(Eigen::AngleAxisd(quarters * kPi / 2, Vector3d::UnitZ()));
  camera.depth = turned(camera.depth);
  camera.color = turned(camera.color);
  camera.depth_from_color = turn * camera.depth_from_color * turn.inverse();
  const std::string folder = fresh_folder() + "/recording";
  mapping::RecordingWriter writer(folder, camera, "");
  for (size_t i = 0; i < 60; i += 3) {
    mapping::RgbdFrame frame = recording->frame(i);
    frame.map_from_camera.reset();
    frame.camera = camera;
    for (cv::Mat* image : {&frame.depth, &frame.color})
      if (quarters > 0) cv::rotate(*image, *image, turns.at(static_cast<size_t>(quarters - 1)));
    writer.add(frame);
  }
  writer.finish();
  return folder;
}

TEST(RecordAndInfo, AHandHeldRecordingWithoutPosesIsTrackedAndUprightHoweverTheCameraIsHeld) {
  LOCI_NEEDS_SHARED("data/redkitchen_30hz");
  for (const int quarters : {0, 1, 2}) {
    const std::string folder = fresh_folder(), recording = hand_held(quarters);
    const Outcome fused = run("loci-map fuse " + recording + " -o " + folder + "/scans");
    EXPECT_THAT(fused.error, HasSubstr("the recording has no poses: 20 of 20 frames tracked"));
    const Outcome map = run("loci-map interpret " + folder + "/scans -o " + folder + "/map --json");
    ASSERT_EQ(map.exit_code, 0) << map.error;
    EXPECT_GT(fs::file_size(folder + "/map/room.glb"), 100000U);
    const Json links = read_json(folder + "/map/map.semantic.json")["links"];
    ASSERT_TRUE(links.contains("table_1")) << quarters << ": " << links.dump();
    EXPECT_NEAR(links["table_1"]["geometry"]["height"].get<double>(), 0.72, 0.02) << quarters;
    if (quarters % 2 == 0) continue;
    const Outcome seen = run("loci-perceive run " + recording + " --map " + folder + "/map/map.urdf -m " +
                             folder + "/m.loci --every 4");
    EXPECT_EQ(seen.exit_code, 0) << seen.error;
    EXPECT_THAT(run("loci-memory objects -m " + folder + "/m.loci").out, HasSubstr("on table_1"));
  }
}

/// A part of a video as a folder in the layout of 7-Scenes, without its poses.
std::string part_of_video(const std::string& folder, int first, int last, int every) {
  const fs::path video = shared("data/redkitchen_30hz/frames");
  fs::create_directories(folder);
  fs::copy_file(video.parent_path() / "cameras.yaml", folder + "/cameras.yaml");
  for (int i = first; i < last; i += every)
    for (const char* part : {"color.jpg", "depth.png"}) {
      const std::string name = fmt::format("frame-{:06}.{}", i, part);
      fs::copy_file(video / name, folder + "/" + name);
    }
  return folder;
}

TEST(RecordAndInfo, WhatHasNoPosesInTheFrameOfTheMapIsPlacedInIt) {
  LOCI_NEEDS_SHARED("data/redkitchen_30hz");
  const std::string folder = fresh_folder(), map = folder + "/map/map.urdf";
  ASSERT_EQ(run("loci-map fuse " + shared("data/redkitchen_30hz/frames") + " --every 6 -o " + folder +
                "/map/scans && loci-map interpret " + folder + "/map/scans -o " + folder + "/map")
                .exit_code,
            0);
  const auto perceive = [&](const std::string& recording, const std::string& more = {}) {
    return run("loci-perceive run " + recording + " --map " + map + " " + more);
  };
  const std::string video = part_of_video(folder + "/video", 0, 60, 3);
  ASSERT_EQ(run("loci-map track " + video + " -o " + folder + "/posed").exit_code, 0);
  const Outcome posed = perceive(folder + "/posed", "--every 8");
  EXPECT_EQ(posed.exit_code, 0) << posed.error;
  EXPECT_THAT(posed.error,
              HasSubstr("the poses are in another frame than the map: the recording was placed"));
  const Outcome updated = run("loci-map update " + map + " " + folder + "/posed -o " + folder + "/updated");
  EXPECT_EQ(updated.exit_code, 0) << updated.error;
  EXPECT_THAT(updated.error,
              HasSubstr("the poses are in another frame than the map: the recording was placed"));
  const Outcome in_map = perceive(shared("data/redkitchen_30hz/frames"), "--every 60");
  EXPECT_THAT(in_map.error, testing::Not(HasSubstr("placed"))) << "its poses fit";
  EXPECT_EQ(in_map.exit_code, 0) << in_map.error;
  const std::string one = part_of_video(folder + "/one", 0, 1, 1);
  for (const char* more : {"", "--fixed-camera"}) {
    const Outcome outcome = perceive(one, more);
    EXPECT_THAT(outcome.error, HasSubstr("the recording was placed in the map")) << more;
    EXPECT_THAT(outcome.error, testing::Not(HasSubstr("first supporting plane")));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  fs::rename(folder + "/map/scans", folder + "/scans");
  expect_one_line_refusal(perceive(one, "--quiet"),
                          "the map has no scans beside it to place the recording by");
}

}  // namespace
}  // namespace loci::apps::test
