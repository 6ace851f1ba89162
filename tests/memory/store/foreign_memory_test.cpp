// Memories that others made: what a file brings along is neither run nor believed.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "mapping/image/image_io.h"
#include "memory/store/memory_file.h"
#include "memory/store/rows/merge.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

class ForeignMemory : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    store.add_recording({.fingerprint = "abc", .name = "day", .kind = "loci"});
    SceneTransaction scene(store, run);
    SceneRow row{.recording = 1, .frame_index = 0, .time = 1000};
    row.camera = SceneCamera{4, 2, 3, 3, 2, 1};
    row.map_from_camera = Isometry3d::Identity();
    row.depth_width = 4;
    row.depth_height = 2;
    row.depth = scene.add_blob(encode_depth_thumbnail(std::vector<float>(8, 1)), kDepthThumbnailMedia);
    row.joints = {{"drawer", 0.1}};
    const Id id = scene.add_scene(row);
    const Id table =
        scene.add_place({.name = "table_1", .class_name = "table", .outline = {{0, 0}, {1, 0}, {1, 1}}});
    const cv::Mat mask(2, 2, CV_8U, cv::Scalar(255));
    const std::vector<unsigned char> png = mapping::encode_image(mask, ".png");
    ObservationRow seen{.scene = id, .number = 0, .place = table, .position = Vector3d(1, 2, 0.8)};
    seen.roi = {1, 0, 2, 2};
    seen.mask = scene.add_blob({reinterpret_cast<const char*>(png.data()), png.size()}, "image/png");
    seen.cloud = scene.add_blob(encode_cluster_depth(std::vector<float>(4, 1)), kClusterDepthMedia);
    const Id observation = scene.add_observation(seen);
    const Id object = scene.add_object({});
    scene.add_association({.scene = id,
                           .observation = observation,
                           .object = object,
                           .explanation = Explanation::appear,
                           .probability = 0.9,
                           .chosen = true});
    scene.add_belief(
        {.object = object, .scene = id, .place = table, .position = Vector3d(1, 2, 0.8), .last_scene = id});
    scene.commit();
  }

  /// A copy of the memory in which somebody has run some SQL.
  fs::path changed(const std::string& sql) {
    const fs::path copy = folder_ / fmt::format("foreign_{}.loci", ++copies_);
    fs::copy_file(file_, copy);
    SQLite::Database database(copy.string(), SQLite::OPEN_READWRITE);
    database.exec(
        "PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON; PRAGMA writable_schema = ON;" +
        sql);
    return copy;
  }

  int copies_ = 0;
};

TEST_F(ForeignMemory, ItsTriggersIndexesAndViewsAreRefusedBeforeAnythingIsRun) {
  const auto refused = ThrowsMessage<Error>(
      AllOf(HasSubstr("foreign_"), HasSubstr("nothing of the file was run"), Not(HasSubstr("\n"))));
  for (const char* sql :
       {"CREATE TRIGGER planted AFTER INSERT ON run BEGIN DELETE FROM scene; END",
        "DROP TRIGGER belief_append_only; CREATE TRIGGER belief_append_only BEFORE UPDATE ON belief BEGIN "
        "SELECT 1; END",
        "CREATE INDEX planted ON scene (abs(time))", "CREATE VIEW planted AS SELECT 1",
        "DROP VIEW v_objects; CREATE VIEW v_objects AS SELECT load_extension('planted') AS object",
        "DROP VIEW v_log", "DROP INDEX scene_time", "CREATE TABLE \"a\nb\" (x)",
        "ALTER TABLE scene ADD COLUMN planted TEXT DEFAULT 'x'",
        "UPDATE sqlite_schema SET sql = replace(sql, 'CHECK (chosen IN (0, 1))', 'CHECK (randomblob(1) OR "
        "1)') WHERE "
        "name = 'association'",
        "CREATE TABLE planted (\"id, (SELECT sql FROM sqlite_schema)\" TEXT)"}) {
    const fs::path file = changed(sql);
    const std::string before = read_file(file);
    EXPECT_THAT([&] { Store::open_read(file); }, refused) << sql;
    EXPECT_THAT([&] { Store::open_write(file); }, refused) << sql;
    EXPECT_THAT([&] { copy_memory(file, folder_ / "copy.loci"); }, refused) << sql;
    NoProgress silent;
    EXPECT_THAT([&] { merge(file_, file, folder_ / "merged.loci", FrameChange{}, silent); }, refused) << sql;
    EXPECT_FALSE(fs::exists(folder_ / "merged.loci"));
    EXPECT_EQ(read_file(file), before) << sql;
  }
}

TEST_F(ForeignMemory, StatisticsOfThePlannerAreNoChange) {
  EXPECT_NO_THROW(Store::open_read(changed("ANALYZE")));
}

TEST_F(ForeignMemory, NumbersThatAreUsedAsSizesIndexesTimesOrEnumeratorsAreChecked) {
  const auto read_all = [](const fs::path& file) {
    const Store store = Store::open_read(file);
    store.places();
    store.beliefs();
    store.runs();
    for (const SceneRow& scene : store.scenes()) {
      depth_thumbnail(store, scene);
      for (const ObservationRow& seen : store.observations(scene.id)) cluster_points(store, scene, seen);
      store.associations(scene.id);
    }
  };
  EXPECT_NO_THROW(read_all(file_));
  for (const char* sql :
       {"UPDATE scene SET camera_width = -4",
        "UPDATE scene SET camera_width = 4294967300",
        "UPDATE scene SET camera_width = 1000000, camera_height = 1000000",
        "UPDATE scene SET camera_height = 0",
        "UPDATE scene SET fx = 0",
        "UPDATE scene SET fx = 9e999",
        "UPDATE scene SET depth_width = -1",
        "UPDATE scene SET depth_width = 1000000000000",
        "UPDATE scene SET depth_height = 3",
        "UPDATE scene SET qw = 0, qx = 0, qy = 0, qz = 0",
        "UPDATE scene SET x = 9e999",
        "UPDATE scene SET time = -9223372036854775808",
        "UPDATE scene SET joints = '[1]'",
        "UPDATE scene SET joints = '{\"a\": {}}'",
        "UPDATE observation SET roi_x = 3",
        "UPDATE observation SET roi_x = -1",
        "UPDATE observation SET roi_y = 2147483647",
        "UPDATE observation SET roi_width = 1",
        "UPDATE observation SET number = 9223372036854775807, roi_x = 1 << 40",
        "UPDATE place SET outline = '[[1]]'",
        "UPDATE place SET outline = '{\"a\": 1}'",
        "UPDATE place SET outline = replace(hex(zeroblob(100000)), '0', '[')",
        "DROP TRIGGER association_append_only; UPDATE association SET explanation = 'magic'; CREATE TRIGGER "
        "association_append_only BEFORE UPDATE ON association BEGIN SELECT RAISE(ABORT, 'rows are only "
        "added'); END",
        "UPDATE blob SET content = x'28b52ffd' WHERE id = 3",
        "UPDATE blob SET size = 1 << 40",
        "UPDATE blob SET encoding = 7"}) {
    const fs::path file = changed(sql);
    EXPECT_THAT([&] { read_all(file); },
                ThrowsMessage<Error>(AllOf(HasSubstr(file.string()), Not(HasSubstr("\n")))))
        << sql;
  }
}

TEST_F(ForeignMemory, ACompressedBombIsNotUnpacked) {
  // A zstd frame that states 2 GB of content.
  const fs::path file =
      changed("UPDATE blob SET encoding = 1, size = 2147483648, content = x'28B52FFDA000000080010000'");
  const Store store = Store::open_read(file);
  EXPECT_THAT([&] { store.blob(1); }, ThrowsMessage<Error>(HasSubstr("damaged")));
}

}  // namespace
}  // namespace loci::memory
