#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/json.h"
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

TEST(RecordAndInfo, AHandHeldRecordingWithoutPosesIsTrackedAndUpright) {
  LOCI_NEEDS_SHARED("data/redkitchen_30hz");
  const fs::path frames = shared("data/redkitchen_30hz/frames"), folder = fresh_folder();
  for (int i = 0; i < 60; i += 3)
    for (const char* image : {"color.jpg", "depth.png"}) {
      const std::string name = fmt::format("frame-{:06}.{}", i, image);
      fs::create_symlink(frames / name, folder / name);
    }
  fs::copy(frames.parent_path() / "cameras.yaml", folder / "cameras.yaml");
  const std::string posed = (folder / "posed").string(), scans = (folder / "scans").string();
  ASSERT_EQ(run("loci-map track " + folder.string() + " -o " + posed).exit_code, 0);
  ASSERT_EQ(run("loci-map fuse " + posed + " -o " + scans).exit_code, 0);
  const Outcome map = run("loci-map interpret " + scans + " -o " + (folder / "map").string());
  EXPECT_EQ(map.exit_code, 0) << map.error;
  EXPECT_THAT(map.out, HasSubstr("table_1")) << "horizontal surfaces are horizontal";
}

}  // namespace
}  // namespace loci::apps::test
