// No stored image shows a face, unless it is asked for.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "memory/store/store.h"
#include "tests/cli/command.h"
#include "tests/support/drawn_arm.h"
#include "tests/support/drawn_person.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

class PeopleInImages : public ::testing::Test {
 protected:
  void SetUp() override {
    mapping::RgbdFrame frame;
    mapping::RecordingWriter writer(folder / "recording", frame.camera, "map");
    for (const double z : {1.7, 2.0, 2.3}) {
      const perception::PeopleFrame person = frame_with_person(z);
      frame.camera = person.camera;
      frame.color = person.color;
      cv::extractChannel(person.points, frame.depth, 2);
      add_table(frame);
      frame.map_from_camera = upright_camera();
      writer.add(frame);
      ++frame.index;
      frame.time_ns += kSecond;
    }
    writer.finish();
  }

  static Isometry3d upright_camera() {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    pose.translation().z() = 1.3;
    return pose;
  }

  /// A table 0.4 m below the camera and up to 1.5 m away, with or without a box of 12 x 8 x 15 cm.
  static void add_table(mapping::RgbdFrame& frame, bool with_box = true) {
    constexpr double kTable = 0.4, kEnd = 1.5, kTop = 0.25, kFront = 1.15, kBack = 1.23;
    const mapping::PinholeCamera& camera = frame.camera.depth;
    const auto set = [&](int u, int v, double z, const cv::Vec3b& color) {
      frame.depth.at<float>(v, u) = static_cast<float>(z);
      frame.color.at<cv::Vec3b>(v, u) = color;
    };
    for (int v = camera.height / 2 + 10; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const Vector3d ray = camera.unproject(u, v, 1);
        const auto across = [&](double z) { return ray.x() * z > 0.2 && ray.x() * z < 0.32; };
        if (kTable / ray.y() < kEnd) set(u, v, kTable / ray.y(), {60, 90, 120});
        if (!with_box) continue;
        const double top = kTop / ray.y(), at_front = kFront * ray.y();
        if (top > kFront && top < kBack && across(top)) set(u, v, top, {50, 50, 230});
        if (at_front > kTop && at_front < kTable && across(kFront)) set(u, v, kFront, {40, 40, 180});
      }
  }

  void run(const std::string& command) {
    const apps::test::Outcome outcome = apps::test::run(std::string(LOCI_BIN_DIR "/") + command);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  size_t faces_in(const cv::Mat& image) {
    perception::PeopleFrame frame;
    frame.color = image;
    const std::vector<perception::Person> people = detector_.detect(frame);
    return static_cast<size_t>(std::count_if(people.begin(), people.end(),
                                             [](const perception::Person& each) { return each.has_face; }));
  }
  /// Of all colour images in a memory; there is at least one per scene.
  size_t faces_in_memory(const std::string& name) {
    const memory::Store store = memory::Store::open_read(folder / name);
    size_t faces = 0, images = 0;
    for (const memory::SceneRow& scene : store.scenes()) {
      std::vector<std::optional<memory::Id>> blobs{scene.image};
      for (const memory::ObservationRow& row : store.observations(scene.id)) blobs.push_back(row.crop);
      for (const std::optional<memory::Id>& id : blobs) {
        if (!id) continue;
        faces += faces_in(mapping::decode_color(store.blob(*id).bytes, "blob"));
        ++images;
      }
    }
    EXPECT_GE(images, 3U);
    return faces;
  }
  static size_t people_in(const memory::Store& store, const memory::SceneRow& scene) {
    return static_cast<size_t>(
        std::ranges::count(store.annotations(scene.id), "person", &memory::AnnotationRow::value));
  }
  size_t faces_in_folder(const std::string& name, const std::string& suffix) {
    size_t faces = 0, images = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / name)) {
      if (!entry.path().filename().string().ends_with(suffix)) continue;
      faces += faces_in(mapping::read_color(entry.path()));
      ++images;
    }
    EXPECT_EQ(images, 3U);
    return faces;
  }

  const fs::path folder = apps::test::fresh_folder();

 private:
  perception::PeopleDetector detector_;
};

TEST_F(PeopleInImages, AreBlurredInMemoriesAndOverlays) {
  run("loci-perceive run " + path("recording") + " -m " + path("day.loci") + " --overlays " +
      path("overlays"));
  EXPECT_EQ(faces_in_memory("day.loci"), 0U);
  EXPECT_EQ(faces_in_folder("overlays", ".png"), 0U);
  const memory::Store store = memory::Store::open_read(folder / "day.loci");
  for (const memory::SceneRow& scene : store.scenes()) {
    EXPECT_EQ(people_in(store, scene), 1U) << "the memory has that somebody was there";
    EXPECT_EQ(store.observations(scene.id).size(), 1U) << "the box; a person is no object";
  }
}

TEST_F(PeopleInImages, AreBlurredWithoutTheirAnnotatorInThePipeline) {
  std::ofstream(folder / "pipeline.yaml") << "flow: [NormalEstimator, PlaneClusterExtractor]\n";
  run("loci-perceive run " + path("recording") + " --pipeline " + path("pipeline.yaml") + " -m " +
      path("day.loci"));
  EXPECT_EQ(faces_in_memory("day.loci"), 0U);
}

TEST_F(PeopleInImages, AreKeptWhenAskedFor) {
  run("loci-perceive run " + path("recording") + " --keep-people -m " + path("day.loci") + " --overlays " +
      path("overlays"));
  EXPECT_EQ(faces_in_memory("day.loci"), 3U);
  EXPECT_EQ(faces_in_folder("overlays", ".png"), 3U);
}

TEST_F(PeopleInImages, AreBlurredWithDetectionsOfAnotherProgram) {
  std::ofstream detections(folder / "detections.jsonl");
  for (int i = 0; i < 3; ++i)
    detections << R"({"time": "1970-01-01T00:00:0)" << i
               << R"(Z", "detections": [{"bbox": [280, 300, 40, 60], "class": {"shirt": 0.9}}]})"
               << "\n";
  detections.close();
  for (const bool kept : {false, true}) {
    const std::string name = kept ? "kept" : "blurred", flag = kept ? " --keep-people" : "";
    run("loci-memory ingest " + path("detections.jsonl") + " --recording " + path("recording") + flag +
        " -m " + path(name + ".loci"));
    EXPECT_EQ(faces_in_memory(name + ".loci"), kept ? 3U : 0U);
  }
}

TEST_F(PeopleInImages, AreBlurredInExportedRecordings) {
  run("loci-perceive run " + path("recording") + " -m " + path("day.loci"));
  for (const bool kept : {false, true}) {
    const std::string name = kept ? "kept" : "blurred", flag = kept ? " --keep-people" : "";
    run("loci-memory export -m " + path("day.loci") + " --dataset " + path(name) + " --recording " +
        path("recording") + flag);
    EXPECT_EQ(faces_in_folder(name, "_color.png"), kept ? 3U : 0U);
    run("loci-perceive convert " + path("recording") + " -o " + path("converted_" + name) + flag);
    EXPECT_EQ(faces_in_folder("converted_" + name, "_color.png"), kept ? 3U : 0U);
  }
}

TEST_F(PeopleInImages, ArmsThatReachInAreNoObjects) {
  mapping::RgbdFrame frame;
  mapping::RecordingWriter writer(folder / "arm", frame.camera, "map");
  Random draw(3);
  for (const bool reaches_in : {false, true, false}) {
    frame.depth = cv::Mat(480, 640, CV_32F, cv::Scalar(2.5));
    frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar(200, 200, 200));
    add_table(frame, frame.index < 2);
    frame.map_from_camera = upright_camera();
    while (reaches_in && !set_arm_into(frame, draw)) {
    }
    writer.add(frame);
    ++frame.index;
    frame.time_ns += 10 * kMinute;
  }
  writer.finish();
  run("loci-perceive run " + path("arm") + " -m " + path("arm.loci"));
  const memory::Store store = memory::Store::open_read(folder / "arm.loci");
  std::vector<size_t> people, objects;
  for (const memory::SceneRow& scene : store.scenes()) {
    people.push_back(people_in(store, scene));
    objects.push_back(store.observations(scene.id).size());
  }
  EXPECT_THAT(people, testing::ElementsAre(0, 1, 0));
  EXPECT_THAT(objects, testing::ElementsAre(1, testing::Le(1), 0)) << "the box, which the arm may hide";
  const apps::test::Outcome who =
      apps::test::run(LOCI_BIN_DIR "/loci-memory ask 'Who took object_1?' -m " + path("arm.loci"));
  EXPECT_THAT(who.out, testing::HasSubstr("somebody was in view at"));
}

}  // namespace
}  // namespace loci
