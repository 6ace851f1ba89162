#include "mapping/simulation/record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "tests/mapping/simulation/samples.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

class Record : public testing::Test {
 protected:
  Record() {
    make_folder(folder_);
    write_file_atomically(
        folder_ / "s.yaml",
        "world: " + (kSamples / "kitchen.urdf").string() +
            "\nobjects:\n  cup: {model: mug, color: [0.8, 0.1, 0.1]}\n  front: {model: box, size: [0.3, "
            "0.02, 0.3]}\n"
            "scenes:\n"
            "  - time: \"2026-05-01T07:00:00Z\"\n    view: {from: [1.6, 1.3, 1.4], at: [1.6, 2.7, 0.9]}\n"
            "    do:\n      - {place: cup, on: counter_1, at: [0, 0]}\n"
            "  - time: \"2026-05-01T08:00:00Z\"\n    view: {from: [1.6, 1.3, 1.4], at: [1.6, 2.7, 0.9]}\n"
            "    do:\n      - {place: front, on: counter_1, at: [0, -0.1]}\n      - {open: drawer_1, to: "
            "0.2}\n");
  }
  ~Record() override { fs::remove_all(folder_); }

  fs::path play(const std::string& name, int seed, int threads, const std::string& noise = "kinect") {
    NoProgress progress;
    Warnings warnings;
    RecordOptions options;
    options.seed = seed;
    options.threads = threads;
    options.noise = noise;
    record(read_scenario(folder_ / "s.yaml"), folder_ / name, options, progress, warnings);
    EXPECT_TRUE(warnings.empty());
    return folder_ / name;
  }
  static std::map<std::string, std::string> files_of(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file())
        files[entry.path().lexically_relative(folder).string()] = read_file(entry.path());
    return files;
  }
  static std::vector<Json> truth_of(const fs::path& folder) {
    std::vector<Json> lines;
    std::istringstream stream(read_file(folder / "truth.jsonl"));
    for (std::string line; std::getline(stream, line);) lines.push_back(parse_json(line, "truth.jsonl"));
    return lines;
  }

  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("record_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(Record, SameSeedSameBytesWithOneAndTwoThreads) {
  const auto one = files_of(play("one", 5, 1));
  EXPECT_EQ(one, files_of(play("two", 5, 2)));
  const auto other = files_of(play("other", 6, 1));
  EXPECT_NE(one.at("frames/000000_depth.png"), other.at("frames/000000_depth.png"));
  EXPECT_EQ(one.at("truth.jsonl"), other.at("truth.jsonl"));
}

TEST_F(Record, WhatWasWrittenIsReadAsARecording) {
  const auto recording = open_recording(play("rec", 1, 2));
  EXPECT_EQ(recording->size(), 2U);
  EXPECT_EQ(recording->info().map_frame, "map");
  EXPECT_FALSE(recording->info().time_assumed);
  EXPECT_TRUE(recording->info().problems.empty());
  EXPECT_EQ(recording->frame(0).joints.size(), 0U);
  EXPECT_EQ(recording->frame(1).joints.at("drawer_1_front_joint"), 0.2);
}

TEST_F(Record, AWorldWhoseFloorIsNotAtZeroIsNoMapFrame) {
  const std::string text = read_file(folder_ / "s.yaml");
  write_file_atomically(folder_ / "s.yaml", "floor: -0.45\n" + text);
  EXPECT_EQ(open_recording(play("low", 1, 2))->info().map_frame, "world");
}

TEST_F(Record, WithoutNoiseDepthIsThatOfTheTruth) {
  const fs::path folder = play("rec", 1, 2, "none");
  const RgbdFrame frame = open_recording(folder)->frame(0);
  const Json cup = truth_of(folder)[0]["objects"][0];
  EXPECT_EQ(cup["id"], "cup");
  EXPECT_EQ(cup["support"], "counter_1");
  // All pixels of the cup's box that are above the counter lie on the cup.
  const auto box = cup["box"].get<std::array<int, 4>>();
  int above = 0;
  for (int v = box[1]; v <= box[3]; ++v) {
    for (int u = box[0]; u <= box[2]; ++u) {
      const Vector3d point =
          *frame.map_from_camera *
          frame.camera.depth.unproject(u, v, static_cast<double>(frame.depth.at<float>(v, u)));
      if (point.z() < 0.905 || point.z() > 1.0 || point.y() > 2.8) continue;
      EXPECT_LT((point.head<2>() - Vector2d(1.6, 2.7)).norm(), 0.08);
      ++above;
    }
  }
  EXPECT_GT(above, 400);
  EXPECT_LE(above, cup["pixels"].get<int>());
}

TEST_F(Record, TruthKnowsWhatIsHidden) {
  const auto truth = truth_of(play("rec", 1, 2));
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_EQ(truth[0]["objects"][0]["visible"], 1.0);
  const Json& hidden = truth[1]["objects"][0];
  EXPECT_EQ(hidden["id"], "cup");
  EXPECT_LT(hidden["visible"].get<double>(), 0.05);
  EXPECT_EQ(truth[1]["objects"][1]["visible"], 1.0);
  EXPECT_EQ(truth[1]["joints"]["drawer_1_front_joint"], 0.2);
  EXPECT_EQ(truth[1]["time"], "2026-05-01T08:00:00Z");
}

TEST_F(Record, InterruptedRecordingLeavesNothing) {
  class Stop : public Progress {
    bool update(double fraction, std::string_view) override { return fraction < 0.4; }
  } stop;
  Warnings warnings;
  EXPECT_THROW(record(read_scenario(folder_ / "s.yaml"), folder_ / "rec", {}, stop, warnings), Interrupted);
  EXPECT_FALSE(fs::exists(folder_ / "rec"));
  EXPECT_FALSE(fs::exists(folder_ / "rec.partial"));
}

}  // namespace
}  // namespace loci::mapping
