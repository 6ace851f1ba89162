// Detections in images, lifted by the depth of a recording with known boxes.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "memory/ingest/ingest.h"
#include "memory/reasoning/reason.h"
#include "memory/store/scene_images.h"
#include "tests/support/box_table.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Lifted : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    const auto view = [](int64_t) { return test::BoxTable{test::table_camera(0.15)}; };
    test::record_table(
        folder_ / "recording", 3, view,
        [](int64_t i) -> std::optional<Isometry3d> {
          if (i == 2) return std::nullopt;
          return test::table_camera(0.15);
        },
        "map");
    options_.recording = folder_ / "recording";
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The box at x = 0 in the image, as x, y, width, height.
  static cv::Rect2d box_in_image() {
    const Isometry3d camera_from_map = test::table_camera(0.15).inverse();
    Eigen::AlignedBox2d extent;
    for (const double x : {-0.04, 0.04})
      for (const double y : {0.76, 0.84})
        for (const double z : {0.7, 0.78})
          extent.extend(test::table_cameras().color.project(camera_from_map * Vector3d(x, y, z)) +
                        Vector2d(0.5, 0.5));
    return {extent.min().x(), extent.min().y(), extent.sizes().x(), extent.sizes().y()};
  }
  static std::string line(int second, const std::string& detections) {
    return fmt::format("{{\"time\": \"2023-11-14T22:13:{:02}Z\", \"detections\": [{}]}}\n", 20 + second,
                       detections);
  }
  static std::string bbox() {
    const cv::Rect2d box = box_in_image();
    return fmt::format(
        "{{\"bbox\": [{}, {}, {}, {}], \"class\": {{\"mug\": 0.9}}, \"key_points\": {{\"rim\": [{}, {}]}}}}",
        box.x, box.y, box.width, box.height, box.x + box.width / 2, box.y + box.height / 2);
  }
  IngestResult take(const std::string& name, const std::string& text) {
    write_file_atomically(folder_ / name, text);
    return ingest(folder_ / name, folder_ / "memory.loci", options_, {}, progress_, warnings_);
  }
  ObservationRow first_observation() const {
    const Store store = Store::open_read(folder_ / "memory.loci");
    return store.observations(store.scenes().front().id).front();
  }

  fs::path folder_ = fs::temp_directory_path() / fmt::format("loci_lifted_{}", getpid());
  IngestOptions options_;
  NoProgress progress_;
  Warnings warnings_;
};

TEST_F(Lifted, TheMemoryKnowsTheColorCamera) {
  take("d.jsonl", line(0, bbox()));
  const Store plain = Store::open_read(folder_ / "memory.loci");
  EXPECT_TRUE(plain.feature_structures(plain.scenes().front().id, "loci.cv.CameraInfo").empty())
      << "registered to the depth";
  fs::remove(folder_ / "memory.loci");
  fs::remove_all(folder_ / "recording");
  mapping::RgbdCamera cameras = test::table_cameras();
  cameras.color = {240, 120, 150, 150, 120, 60};
  cameras.depth_from_color.translation().x() = 0.025;
  mapping::RecordingWriter writer(folder_ / "recording", cameras, "map");
  mapping::RgbdFrame frame = test::table_frame({test::table_camera(0.15)}, cameras, 0);
  frame.map_from_camera = test::table_camera(0.15);
  writer.add(frame);
  writer.finish();
  take("d.jsonl", line(0, bbox()));
  const auto check = [&](const fs::path& memory) {
    const Store store = Store::open_read(memory);
    const mapping::RgbdCamera known = cameras_of(store, store.scenes().front());
    EXPECT_EQ(known.depth, cameras.depth);
    EXPECT_EQ(known.color, cameras.color);
    EXPECT_TRUE(known.depth_from_color.isApprox(cameras.depth_from_color));
  };
  check(folder_ / "memory.loci");
  reason(Store::open_read(folder_ / "memory.loci"), folder_ / "reasoned.loci", {}, {}, progress_);
  check(folder_ / "reasoned.loci");
}

TEST_F(Lifted, ANewMemoryTakesTheTimeZoneOfTheRecordingBeforeTheMachines) {
  options_.default_time_zone = "Asia/Kathmandu";
  take("d.jsonl", line(0, bbox()));
  EXPECT_EQ(Store::open_read(folder_ / "memory.loci").time_zone().name(), "Asia/Kathmandu");
  fs::remove(folder_ / "memory.loci");
  const fs::path yaml = folder_ / "recording/recording.yaml";
  write_file_atomically(yaml, read_file(yaml) + "time_zone: Europe/Berlin\n");
  take("d.jsonl", line(0, bbox()));
  EXPECT_EQ(Store::open_read(folder_ / "memory.loci").time_zone().name(), "Europe/Berlin");
}

TEST_F(Lifted, BoxOfALineBecomesAnObjectWithPlaceSizeAndColour) {
  const IngestResult result = take("d.jsonl", line(0, bbox()) + line(1, bbox()));
  EXPECT_EQ(result.detections, 2U);
  EXPECT_EQ(result.lifted.used(), 2U);
  const ObservationRow row = first_observation();
  ASSERT_TRUE(row.position && row.size && row.hsv);
  // Top and front of the box are seen: its centre but for the unseen back.
  EXPECT_NEAR(row.position->x(), 0, 0.01);
  EXPECT_NEAR(row.position->y(), 0.8, 0.02);
  EXPECT_NEAR(row.position->z(), 0.745, 0.015);
  EXPECT_NEAR(row.size->x(), 0.08, 0.02);
  EXPECT_NEAR(row.hsv->hue, 25, 2);
  EXPECT_GT(row.points.value_or(0), 25);
  EXPECT_TRUE(row.mask.has_value());
}

TEST_F(Lifted, PosesAreMovedIntoTheFrameOfTheMap) {
  const fs::path yaml = folder_ / "recording/recording.yaml";
  std::string text = read_file(yaml);
  text.replace(text.find("map_frame: map"), 14, "map_frame: odom");
  write_file_atomically(yaml, text);
  options_.map = folder_ / "map.urdf";
  write_file_atomically(options_.map, "<robot name=\"room\"><link name=\"map\"/></robot>");
  write_file_atomically(
      folder_ / "map.semantic.json",
      R"({"version": 1, "frame": "map", "links": {}, "map_from_input": [0, 0, 1.5, 0, 0, 0, 1]})");
  take("d.jsonl", line(0, bbox()));
  EXPECT_NEAR(first_observation().position->z(), 1.5 + 0.745, 0.015);
}

TEST_F(Lifted, MaskIsTighterThanItsBox) {
  const cv::Rect2d box = box_in_image();
  const std::string polygon =
      fmt::format("[[{0}, {1}, {2}, {1}, {2}, {3}, {0}, {3}]]", box.x, box.y, box.br().x, box.br().y);
  take("d.jsonl", line(0, "{\"bbox\": [0, 0, 160, 120], \"mask\": " + polygon + "}"));
  EXPECT_NEAR(first_observation().position->x(), 0, 0.03);
}

TEST_F(Lifted, KeyPointsAreKept) {
  take("d.jsonl", line(0, bbox()));
  const Store store = Store::open_read(folder_ / "memory.loci");
  bool found = false;
  for (const AnnotationRow& row : store.annotations(store.scenes().front().id))
    found = found || (row.type == "loci.hypothesis.KeyPoint" && row.value.starts_with("rim "));
  EXPECT_TRUE(found);
}

TEST_F(Lifted, CocoFile) {
  const cv::Rect2d box = box_in_image();
  const IngestResult result = take(
      "coco.json",
      fmt::format(R"({{"images": [{{"id": 1, "file_name": "000000_color.png", "width": 160, "height": 120}},
                                  {{"id": 9, "file_name": "000077_color.png"}}],
                      "categories": [{{"id": 3, "name": "mug"}}],
                      "annotations": [{{"image_id": 1, "category_id": 3, "bbox": [{}, {}, {}, {}]}}]}})",
                  box.x, box.y, box.width, box.height));
  EXPECT_EQ(result.scenes, 1U);
  EXPECT_EQ(result.lifted.used(), 1U);
  EXPECT_EQ(result.used.count(Reason::no_matching_frame), 1U);
  EXPECT_NEAR(first_observation().position->x(), 0, 0.01);
}

TEST_F(Lifted, AnImageOfAnotherShapeIsRefused) {
  const auto taken = [&](int width, int height) {
    fs::remove(folder_ / "memory.loci");
    return take(
        "coco.json",
        fmt::format(R"({{"images": [{{"id": 1, "file_name": "000000_color.png", "width": {}, "height": {}}}],
                      "categories": [{{"id": 3, "name": "mug"}}],
                      "annotations": [{{"image_id": 1, "category_id": 3, "bbox": [10, 10, 20, 20]}}]}})",
                    width, height));
  };
  EXPECT_EQ(taken(320, 240).scenes, 1U) << "evenly scaled";
  try {
    taken(80, 120);
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("80 x 120"));
    EXPECT_THAT(error.what(), HasSubstr("160 x 120"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "memory.loci")) << "nothing was added";
}

TEST_F(Lifted, NoMemoryIsLeftWhereNothingWasAdded) {
  const std::string none =
      R"({"images": [{"id": 1, "file_name": "000077_color.png", "width": 160, "height": 120}],
          "categories": [{"id": 3, "name": "mug"}],
          "annotations": [{"image_id": 1, "category_id": 3, "bbox": [10, 10, 20, 20]}]})";
  EXPECT_EQ(take("coco.json", none).scenes, 0U);
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_FALSE(entry.path().filename().string().starts_with("memory.loci")) << entry.path();
  take("d.jsonl", line(0, bbox()));
  take("coco.json", none);
  EXPECT_EQ(Store::open_read(folder_ / "memory.loci").scenes().size(), 1U) << "what was there stays";
}

TEST_F(Lifted, YoloFolderTwiceNeedsResume) {
  const cv::Rect2d box = box_in_image();
  fs::create_directories(folder_ / "yolo");
  write_file_atomically(folder_ / "yolo/classes.txt", "mug\n");
  write_file_atomically(folder_ / "yolo/000000_color.txt",
                        fmt::format("0 {} {} {} {} 0.9\n", (box.x + box.width / 2) / 160,
                                    (box.y + box.height / 2) / 120, box.width / 160, box.height / 120));
  const auto again = [&] {
    return ingest(folder_ / "yolo", folder_ / "memory.loci", options_, {}, progress_, warnings_);
  };
  EXPECT_EQ(again().lifted.used(), 1U);
  EXPECT_NEAR(first_observation().position->x(), 0, 0.01);
  EXPECT_THROW(again(), Error);
  options_.resume = true;
  EXPECT_EQ(again().present, 1U);
}

TEST_F(Lifted, WhatCannotBeLiftedIsCountedWithTheReason) {
  const IngestResult result = take(
      "d.jsonl", line(0, bbox() + R"(, {"bbox": [500, 10, 20, 20]})") + line(2, bbox()) + line(30, bbox()));
  EXPECT_EQ(result.lifted.used(), 1U);
  EXPECT_EQ(result.lifted.count(Reason::outside_image), 1U);
  EXPECT_EQ(result.lifted.count(Reason::no_pose), 1U);
  EXPECT_EQ(result.lifted.count(Reason::no_matching_frame), 1U);
  EXPECT_EQ(result.scenes, 1U) << "scenes in which nothing could be lifted say nothing";
  EXPECT_THAT(result.summary(), HasSubstr("1 of 4 lifted to 3-D, the others not: "));
}

TEST_F(Lifted, WithoutRecordingARegionIsABadLine) {
  options_.recording.clear();
  options_.strict = true;
  try {
    take("d.jsonl", line(0, bbox()));
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("d.jsonl:1"));
    EXPECT_THAT(error.what(), HasSubstr("--recording"));
  }
}

TEST_F(Lifted, HostileLinesAreBadLines) {
  // A file of which most lines are bad is refused.
  std::string again;
  for (int i = 0; i < 6; ++i) again += line(0, bbox());
  const IngestResult result =
      take("d.jsonl", line(0, bbox()) + again + line(1, R"({"bbox": [1, 2, -3, 4]})") +
                          line(1, R"({"bbox": [1, 2, 1e999, 4]})") + line(1, R"({"mask": "../secret.png"})") +
                          line(1, R"({"mask": {"size": [120, 160], "counts": [4294967295, 4294967295]}})") +
                          line(1, R"({"mask": {"size": [2000000000, 2000000000], "counts": []}})") +
                          line(1, R"({"bbox": [1, 2, 3, 4], "key_points": {"rim": [1]}})"));
  EXPECT_EQ(result.bad, 6U);
  EXPECT_EQ(result.scenes, 1U);
}

}  // namespace
}  // namespace loci::memory
