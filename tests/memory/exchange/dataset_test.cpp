// Two things on a table that are seen in three scenes, and what is said of them.

#include "memory/exchange/dataset.h"

#include <gtest/gtest.h>

#include "mapping/base/text/csv.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "memory/edits/edits.h"
#include "memory/questions/facts.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

class DatasetTest : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    testing_support::TemporaryFolder::SetUp();
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    for (int i = 0; i < 3; ++i) add_scene(store, run, (i + 1) * kSecond);
  }

  void add_scene(Store& store, Id run, TimeNs time) {
    SceneTransaction scene(store, run);
    const Id depth =
        scene.add_blob(encode_depth_thumbnail(std::vector<float>(40 * 30, 1.5F)), kDepthThumbnailMedia);
    const auto png = mapping::encode_image(cv::Mat(60, 80, CV_8U, cv::Scalar(255)), ".png");
    const Id mask = scene.add_blob({reinterpret_cast<const char*>(png.data()), png.size()}, "image/png");
    const Id id = scene.add_scene({.time = time,
                                   .camera = SceneCamera{160, 120, 150, 150, 79.5, 59.5, {}, {}},
                                   .map_from_camera = Isometry3d::Identity(),
                                   .depth = depth,
                                   .depth_width = 40,
                                   .depth_height = 30});
    for (Id number = 0; number < 2; ++number) {
      ObservationRow row{.scene = id, .number = number, .crop = mask, .mask = mask};
      row.roi = {number == 0 ? 0 : 80, 20, 80, 60};
      const Id seen = scene.add_observation(row);
      if (time == kSecond) scene.add_object({});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = number + 1,
                             .explanation = Explanation::stay,
                             .probability = 1,
                             .chosen = true});
      scene.add_belief({.object = number + 1,
                        .scene = id,
                        .status = ObjectStatus::seen,
                        .position = Vector3d(0, 0, 1),
                        .last_scene = id});
      scene.add_annotation({.scene = id,
                            .observation = seen,
                            .type = "loci.annotation.ClassificationAnnotation",
                            .value = number == 0 ? "bowl" : "plate",
                            .confidence = 0.6});
    }
    scene.commit();
  }

  NoProgress silent_;
};

TEST_F(DatasetTest, LabelsOfPeopleComeFirstThenFactsThenAnnotators) {
  Store store = Store::open_write(file_);
  const ObservationRow first = store.observations(1).front();
  EXPECT_EQ(class_of(store, first, 1).name, "bowl");
  set_fact(store, "object_1", "class", "mug");
  EXPECT_EQ(class_of(store, first, 1).by, "fact");
  label_observation(store, 1, 0, "cup");
  EXPECT_EQ(class_of(store, first, 1).name, "cup");
  EXPECT_EQ(class_of(store, store.observations(2).front(), 1).name, "mug") << "a label is of one image";
}

TEST_F(DatasetTest, IsARecordingWhoseLabelsSayWhatIsWhere) {
  const Store store = Store::open_read(file_);
  const DatasetResult result = export_dataset(store, folder_ / "data", {}, silent_);
  EXPECT_EQ(result.objects, 6U);
  EXPECT_EQ(result.classes.at("plate"), 3U);
  const auto recording = mapping::open_recording(folder_ / "data");
  ASSERT_EQ(recording->size(), 3U);
  const mapping::RgbdFrame frame = recording->frame(1);
  EXPECT_EQ(frame.index, 2) << "the scene's number";
  EXPECT_NEAR(frame.depth.at<float>(3, 3), 1.5, 1e-3);
  EXPECT_NEAR(frame.camera.depth.fx, 150.0 / 4, 1e-9);
  EXPECT_NEAR(frame.camera.depth.cx, 19.5, 1e-9) << "the middle stays the middle";
  const cv::Mat labels = mapping::read_uint16(folder_ / "data/frames/000002_label.png");
  EXPECT_EQ(labels.at<uint16_t>(10, 5), 20);
  EXPECT_EQ(labels.at<uint16_t>(10, 30), 30);
  EXPECT_EQ(labels.at<uint16_t>(1, 5), 0);
  const CsvTable table = CsvTable::read(folder_ / "data/objects.csv");
  ASSERT_EQ(table.rows(), 6U);
  for (size_t row = 0; row < table.rows(); ++row) {
    EXPECT_EQ(table.cell(row, table.require_column("class")), table.integer(row, 1) == 20 ? "bowl" : "plate");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "data" / table.cell(row, table.require_column("mask"))));
  }
}

TEST_F(DatasetTest, ByObjectEachObjectIsItsOwnClass) {
  DatasetOptions options;
  options.by_object = true;
  const DatasetResult result = export_dataset(Store::open_read(file_), folder_ / "data", options, silent_);
  EXPECT_EQ(result.classes.at("object_2"), 3U);
}

TEST_F(DatasetTest, WithoutDepthThereIsNone) {
  {
    Store store = Store::open_write(folder_ / "numbers.loci");
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene({.time = kSecond});
    scene.commit();
  }
  EXPECT_THROW(export_dataset(Store::open_read(folder_ / "numbers.loci"), folder_ / "data", {}, silent_),
               Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data"));
}

}  // namespace
}  // namespace loci::memory
