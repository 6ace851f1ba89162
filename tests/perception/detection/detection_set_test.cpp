#include "perception/detection/detection_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "mapping/base/files.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

class Detections : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "yolo"); }
  void TearDown() override { fs::remove_all(folder_); }

  DetectionSet coco(const std::string& text) {
    write_file_atomically(folder_ / "coco.json", text);
    return DetectionSet::read(folder_ / "coco.json", warnings_);
  }
  DetectionSet yolo(const std::string& text, const std::string& name = "frame-000003.color.txt") {
    write_file_atomically(folder_ / "yolo" / name, text);
    return DetectionSet::read(folder_ / "yolo", warnings_);
  }
  std::string refusal(const std::string& line) {
    try {
      yolo(line);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  fs::path folder_ = fs::temp_directory_path() / ("loci_detections_" + std::to_string(::getpid()));
  Warnings warnings_;
};

TEST_F(Detections, CocoDataSet) {
  const DetectionSet set = coco(R"({
    "images": [{"id": 7, "file_name": "rgb/frame-000012.color.png", "width": 640, "height": 480},
               {"id": 8, "file_name": "rgb/frame-000013.color.png"}],
    "categories": [{"id": 41, "name": "mug", "keypoints": ["handle", "rim"]}],
    "annotations": [
      {"image_id": 7, "category_id": 41, "bbox": [10, 20, 30, 40], "score": 0.75,
       "keypoints": [12, 22, 2, 0, 0, 0]},
      {"image_id": 7, "category_id": 41, "segmentation": [[10, 20, 30, 20, 30, 40]], "bbox": [10, 20, 20, 20]}]})");
  const ImageDetections* image = set.find("frame-000012", 12, 0);
  ASSERT_NE(image, nullptr);
  ASSERT_EQ(image->detections.size(), 2U);
  const Detection2D& first = image->detections[0];
  EXPECT_EQ(first.classes, (std::vector<std::pair<std::string, double>>{{"mug", 0.75}}));
  EXPECT_EQ(first.region.box, cv::Rect2d(10, 20, 30, 40));
  EXPECT_EQ(first.region.image, cv::Size(640, 480));
  ASSERT_EQ(first.key_points.size(), 1U);
  EXPECT_EQ(first.key_points[0].name, "handle");
  EXPECT_FALSE(image->detections[1].region.mask.empty());
  ASSERT_NE(set.find("frame-000013", 13, 0), nullptr);
  EXPECT_TRUE(set.find("frame-000013", 13, 0)->detections.empty());
  EXPECT_EQ(set.find("frame-000014", 14, 0), nullptr);
}

TEST_F(Detections, CocoResultsAreMatchedByNumber) {
  const DetectionSet set = coco(R"([{"image_id": 3, "category_id": 1, "bbox": [1, 2, 3, 4], "score": 0.5}])");
  ASSERT_NE(set.find("000003", 3, 0), nullptr);
  EXPECT_EQ(set.find("000003", 3, 0)->detections[0].classes[0].first, "class_1");
  EXPECT_EQ(warnings_.texts().size(), 1U);
}

TEST_F(Detections, CocoWithOneIdForTwoIsRefused) {
  const auto file = [](const std::string& images, const std::string& categories, const std::string& more) {
    return R"({"images": [{"id": 1, "file_name": "a.png"})" + images +
           R"(], "categories": [{"id": 1, "name": "cup"})" + categories +
           R"(], "annotations": [{"image_id": 1, "category_id": 1, "bbox": [1, 2, 3, 4])" + more + "}]}";
  };
  EXPECT_EQ(coco(file("", "", "")).images()[0].detections.size(), 1U);
  EXPECT_THROW(coco(file(R"(, {"id": 1, "file_name": "b.png"})", "", "")), Error);
  EXPECT_THROW(coco(file("", R"(, {"id": 1, "name": "mug"})", "")), Error);
  EXPECT_THROW(coco(file("", "", R"(, "iscrowd": 2)")), Error);
  EXPECT_TRUE(coco(file("", "", R"(, "iscrowd": 1)")).images()[0].detections.empty());
  EXPECT_THAT(warnings_.texts(), testing::Contains(testing::HasSubstr("iscrowd")));
}

TEST_F(Detections, DamagedCocoIsRefused) {
  for (const char* text :
       {"", "{", "7", "{}", R"({"images": [], "categories": [], "annotations": []})",
        R"([{"image_id": 3, "category_id": 1}])",
        R"([{"image_id": 3.5, "category_id": 1, "bbox": [1,2,3,4]}])",
        R"([{"image_id": 3, "category_id": 1, "bbox": [1, 2, 3, 4], "score": 7}])",
        R"({"images": [{"id": 1, "file_name": "a.png", "width": -1, "height": 1}], "categories": [],
            "annotations": []})",
        R"({"images": [{"id": 1, "file_name": "a.png"}], "categories": [],
            "annotations": [{"image_id": 2, "category_id": 1, "bbox": [1, 2, 3, 4]}]})"})
    EXPECT_THROW(coco(text), Error) << text;
  EXPECT_THROW(coco(std::string(100'000, '[')), Error);
}

TEST_F(Detections, DamagedCocoNamesLineByteOrKey) {
  const auto why = [&](const std::string& text) -> std::string {
    try {
      coco(text);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const std::string head =
      R"({"images": [{"id": 1, "file_name": "a.png"}], "categories": [], "annotations": [)";
  EXPECT_THAT(why(head + R"({"image_id": 1, "category_id": 1, "bbox": [1, NaN, 2, 3]}]})"),
              testing::HasSubstr("coco.json: annotations[0].bbox: must be a finite number, is NaN"));
  EXPECT_THAT(why("{\n\"images\": [\n"),
              testing::HasSubstr("coco.json:3: is not valid JSON: it is cut off at byte"));
  EXPECT_THAT(why("{\n  \"images\": x,\n  \"annotations\": []}"),
              testing::HasSubstr("coco.json:2: is not valid JSON at byte 13"));
  EXPECT_EQ(why(head + R"({"image_id": 1, "category_id": 1, "bbox": [1, 1, 2, 3], "area": NaN}]})"), "");
  EXPECT_THAT(why(R"([{"time": "2026-05-01T08:00:00Z", "detections": []}])"),
              testing::HasSubstr("write one scene per line"));
}

TEST_F(Detections, YoloFolder) {
  write_file_atomically(folder_ / "yolo" / "classes.txt", "bowl\nmug\n");
  const DetectionSet set = yolo("1 0.5 0.25 0.1 0.2 0.9\n0 0.1 0.1 0.3 0.1 0.3 0.3 0.1 0.3\n\n");
  const ImageDetections* image = set.find("frame-000003", 3, 0);
  ASSERT_NE(image, nullptr);
  ASSERT_EQ(image->detections.size(), 2U);
  EXPECT_EQ(image->detections[0].classes[0], (std::pair<std::string, double>("mug", 0.9)));
  EXPECT_NEAR(image->detections[0].region.box.x, 0.45, 1e-9);
  EXPECT_NEAR(image->detections[0].region.box.y, 0.15, 1e-9);
  EXPECT_EQ(image->detections[1].classes[0].first, "bowl");
  EXPECT_FALSE(image->detections[1].region.mask.empty());
}

TEST_F(Detections, ClassesThatTheFileDoesNotDefineAreRefused) {
  write_file_atomically(folder_ / "yolo" / "classes.txt", "bowl\nmug\n");
  const auto why = [&](const auto& read) -> std::string {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const std::string lines = why([&] { yolo("0 0.5 0.25 0.1 0.2 0.9\n2 0.5 0.25 0.1 0.2 0.9\n"); });
  EXPECT_THAT(lines, testing::HasSubstr(".txt:2: has class 2, and there are names of the classes 0 to 1"));
  EXPECT_THAT(lines, testing::HasSubstr("is the first class 0 or 1?"));
  const std::string head = R"({"images": [{"id": 1, "file_name": "a.png"}], "categories": [)";
  const std::string tail = R"(], "annotations": [{"image_id": 1, "category_id": 99, "bbox": [1, 1, 2, 3]}]})";
  EXPECT_THAT(why([&] { coco(head + R"({"id": 1, "name": "mug"})" + tail); }),
              testing::HasSubstr("annotations[0].category_id: 99 is none of the file's categories"));
  EXPECT_EQ(coco(head + tail).images()[0].detections[0].classes[0].first, "class_99");
  ASSERT_EQ(warnings_.texts().size(), 1U);
  EXPECT_THAT(warnings_.texts()[0], testing::HasSubstr("is without names of classes"));
}

TEST_F(Detections, ClassNamesComeFromDataYaml) {
  write_file_atomically(folder_ / "data.yaml", "train: images\nnames:\n  0: cup\n  1: plate\n");
  EXPECT_EQ(yolo("1 0.5 0.5 0.1 0.1").images()[0].detections[0].classes[0].first, "plate");
}

TEST_F(Detections, DamagedYoloNamesFileAndLine) {
  for (const char* line :
       {"1 0.5 0.5 0.1", "1 0.5 nan 0.1 0.1", "1 0.5 x 0.1 0.1", "-1 0.5 0.5 0.1 0.1", "1.5 0.5 0.5 0.1 0.1",
        "1 0.5 0.5 0 0.1", "1 0.5 7 0.1 0.1", "1 0.5 0.5 0.1 0.1 3"}) {
    const std::string text = refusal(std::string("0 0.5 0.5 0.1 0.1\n") + line);
    EXPECT_NE(text.find("frame-000003.color.txt:2"), std::string::npos) << line << " -> " << text;
  }
}

TEST_F(Detections, YoloKeyPointsHaveTheShapeOfDataYaml) {
  write_file_atomically(folder_ / "data.yaml", "names: [mug]\nkpt_shape: [2, 3]\n");
  const DetectionSet set =
      yolo("0 0.5 0.5 0.2 0.2 0.45 0.5 2 0 0 0\n0 0.5 0.5 0.2 0.2 0.45 0.5 0.9 0.6 0.6 0.8 0.7\n");
  const std::vector<Detection2D>& found = set.images()[0].detections;
  ASSERT_EQ(found.size(), 2U);
  ASSERT_EQ(found[0].key_points.size(), 1U);  // the other point is not in the image
  EXPECT_EQ(found[0].key_points[0].name, "point_1");
  EXPECT_EQ(found[0].key_points[0].x, 0.45);
  EXPECT_FALSE(found[0].score);
  EXPECT_EQ(found[1].key_points.size(), 2U);
  EXPECT_EQ(found[1].score, 0.7);
  EXPECT_NE(refusal("0 0.5 0.5 0.1 0.1 0.5 0.5").find("11 are expected"), std::string::npos);
}

TEST_F(Detections, JsonLinesAreMatchedByTime) {
  const auto set = [&](const std::string& text) {
    write_file_atomically(folder_ / "scenes.jsonl", text);
    return DetectionSet::read(folder_ / "scenes.jsonl", warnings_);
  };
  const DetectionSet two = set(
      R"({"time": "2026-05-01T08:30:00Z", "detections": [)"
      R"({"bbox": [10, 20, 30, 40], "class": {"mug": 0.3, "cup": 0.6}, "score": 0.8, "key_points": {"rim": [12, 22]}},)"
      R"({"mask": [[10, 20, 30, 20, 30, 40]]}]})"
      "\n"
      R"({"time": "2026-05-01T08:30:00.033Z", "detections": []})");
  const TimeNs time = two.images()[0].time.value();
  const ImageDetections* image = two.find("000000", 0, time + 5'000'000);
  ASSERT_NE(image, nullptr);
  ASSERT_EQ(image->detections.size(), 2U);
  EXPECT_EQ(image->detections[0].classes.front().first, "cup");
  EXPECT_EQ(image->detections[0].key_points.front().name, "rim");
  EXPECT_TRUE(image->detections[1].classes.empty());
  ASSERT_NE(two.find("000001", 1, time + 30'000'000), nullptr);
  EXPECT_TRUE(two.find("000001", 1, time + 30'000'000)->detections.empty());
  EXPECT_EQ(two.find("000002", 2, time + kSecond), nullptr);
  for (const char* bad : {"{", "[]", R"({"detections": []})", R"({"time": 3})", R"({"time": "noon"})",
                          R"({"time": "2026-05-01T08:30:00Z", "detections": [{"position": [1, 2, 3]}]})",
                          R"({"time": "2026-05-01T08:30:00Z", "detections": [7]})"})
    EXPECT_THROW(set(bad), Error) << bad;
}

TEST_F(Detections, ImagesNamedAfterSecondsAreMatchedByTime) {
  const DetectionSet set = yolo("0 0.5 0.5 0.1 0.1", "1305031102.175304.txt");
  const TimeNs time = 1305031102 * kSecond + 160407000;
  EXPECT_NE(set.find("1305031102.160407", 0, time), nullptr);
  EXPECT_EQ(set.find("1305031102.260407", 1, time + kSecond / 10), nullptr);
}

}  // namespace
}  // namespace loci::perception
