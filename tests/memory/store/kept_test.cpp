// What format 1.5 keeps beside the numbers: kinds of pixels, points of clusters, logs, counted rows; and how
// it goes again.

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <limits>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "memory/store/erasure/retention.h"
#include "memory/store/rows/merge.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Kept : public testing_support::TemporaryFolder {
 protected:
  static constexpr int kWidth = 8, kHeight = 6;  // of the thumbnail; the camera has ten times as many

  /// A scene with a thing whose mask is a cross in a square of 20 pixels.
  void add_scene(Store& store, Id run, TimeNs time) {
    SceneTransaction scene(store, run);
    SceneRow row{.time = time,
                 .camera = SceneCamera{80, 60, 60, 60, 40, 30, 0.5, 5.0},
                 .map_from_camera = Isometry3d::Identity(),
                 .depth = scene.add_blob(std::string(2 * kWidth * kHeight, '\1'), "depth/uint16-mm"),
                 .depth_width = kWidth,
                 .depth_height = kHeight};
    std::string kinds(kWidth * kHeight, '\1');
    kinds[2 * kWidth + 3] = 3;
    row.pixel_kinds = scene.add_blob(kinds, kPixelKindsMedia);
    const Id id = scene.add_scene(row);
    scene.add_log({id, 0, "NormalEstimator", "info", "", 12.5});
    scene.add_log({id, 1, "TextReader", "info", "reads HARIBO", {}});
    cv::Mat mask = cv::Mat::zeros(20, 20, CV_8U);
    mask.row(10) = 255;
    mask.col(5) = 255;
    const std::vector<unsigned char> png = mapping::encode_image(mask, ".png");
    std::vector<float> depth(39, 1.0F);
    depth[0] = 1.2344F;
    depth[1] = std::numeric_limits<float>::quiet_NaN();
    depth[2] = 3.0F;
    const Id seen = scene.add_observation(
        {.scene = id,
         .number = 0,
         .mask = scene.add_blob({reinterpret_cast<const char*>(png.data()), png.size()}, "image/png"),
         .roi = std::array<int, 4>{30, 20, 20, 20},
         .cloud = scene.add_blob(encode_cluster_depth(depth), kClusterDepthMedia)});
    if (store.max_object_id() == 0) {
      scene.add_object({});
      scene.add_belief({.object = 1,
                        .scene = id,
                        .status = ObjectStatus::seen,
                        .position = Vector3d(1, 2, 0.8),
                        .last_scene = id});
    }
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = 1,
                           .explanation = Explanation::stay,
                           .probability = 1,
                           .chosen = true});
    scene.set_reasoning(id, "reasons");
    scene.commit();
  }

  void make() {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    for (const TimeNs time : {100 * kSecond, 200 * kSecond, 300 * kSecond}) add_scene(store, run, time);
  }

  static std::vector<std::string> problems(const Store& store) {
    NoProgress silent;
    return store.verify(silent).problems;
  }
};

TEST_F(Kept, ComesBackAsItWasGiven) {
  make();
  const Store store = Store::open_read(file_);
  const SceneRow scene = store.scene(1);
  const auto kinds = pixel_kinds(store, scene);
  ASSERT_TRUE(kinds.has_value());
  EXPECT_EQ(kinds->width, kWidth);
  EXPECT_EQ(kinds->pixels[2 * kWidth + 3], mapping::PixelKind::region_of_interest);
  EXPECT_EQ(kinds->pixels[0], mapping::PixelKind::map_explained);
  const auto cluster = cluster_points(store, scene, store.observation(1));
  ASSERT_TRUE(cluster.has_value());
  ASSERT_EQ(cluster->points.size(), 38U) << "one pixel of the cross was not measured";
  // The first pixel of the cross is the upper end of its bar: column 35, row 20.
  EXPECT_EQ(cluster->pixels[0], 20 * 80 + 35);
  EXPECT_NEAR(cluster->points[0].z(), 1.234F, 1e-6F) << "millimetres";
  EXPECT_NEAR(cluster->points[0].x(), (35 - 40) / 60.0 * 1.234, 1e-5);
  EXPECT_NEAR(cluster->points[0].y(), (20 - 30) / 60.0 * 1.234, 1e-5);
  EXPECT_EQ(cluster->pixels[1], 22 * 80 + 35);
  EXPECT_FLOAT_EQ(cluster->points[1].z(), 3);
  const std::vector<LogRow> log = store.log(1);
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[0].milliseconds, 12.5);
  EXPECT_EQ(log[0].text, "");
  EXPECT_EQ(log[1].text, "reads HARIBO");
  EXPECT_EQ(log[1].milliseconds, std::nullopt);
  SQLite::Database database(file_.string());
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM v_log WHERE annotator = 'TextReader'").getInt(), 3);
  EXPECT_EQ(database.execAndGet("SELECT count(DISTINCT pixel_kinds) FROM scene").getInt(), 1)
      << "stored once";
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST(ClusterDepth, AnyDepthComesBackToTheMillimetre) {
  std::vector<float> depth = {0,      65.535F, 0.001F, 65.0F, 65.536F, std::numeric_limits<float>::infinity(),
                              2.5004F};
  const std::vector<float> back = decode_cluster_depth(encode_cluster_depth(depth));
  ASSERT_EQ(back.size(), depth.size());
  depth[4] = depth[5] = 0;  // farther than can be told
  for (size_t i = 0; i < depth.size(); ++i) EXPECT_NEAR(back[i], depth[i], 0.0005F) << i;
  EXPECT_THAT(decode_cluster_depth(encode_cluster_depth({})), IsEmpty());
}

TEST_F(Kept, GoesByTheRulesOfRetention) {
  make();
  const RetentionResult result = retain(file_, {.images_s = 150, .reasoning_s = 50});
  EXPECT_EQ(result.scenes_without_images, 1);
  EXPECT_EQ(result.observations_without_points, 1);
  EXPECT_EQ(result.scenes_without_reasoning, 2);
  const Store store = Store::open_read(file_);
  EXPECT_FALSE(pixel_kinds(store, store.scene(1)).has_value());
  EXPECT_TRUE(pixel_kinds(store, store.scene(2)).has_value());
  EXPECT_FALSE(cluster_points(store, store.scene(1), store.observation(1)).has_value());
  EXPECT_TRUE(store.observation(1).mask.has_value()) << "crops and masks stay longer";
  EXPECT_TRUE(cluster_points(store, store.scene(2), store.observation(2)).has_value());
  EXPECT_EQ(store.log(1).size(), 2U) << "numbers and words stay";
  EXPECT_FALSE(store.reasoning(2).has_value());
  EXPECT_TRUE(store.reasoning_discarded(2)) << "and it is not that there never was any";
  EXPECT_EQ(store.reasoning(3), "reasons");
  EXPECT_FALSE(store.reasoning_discarded(3));
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST_F(Kept, PointsGoWithTheMaskThatSaysWhereTheyAre) {
  make();
  Store::open_write(file_).retain({.crops_s = 150});
  const Store store = Store::open_read(file_);
  EXPECT_FALSE(store.observation(1).cloud.has_value());
  EXPECT_TRUE(store.observation(2).cloud.has_value());
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST_F(Kept, IsForgottenWithTheObject) {
  make();
  {
    Store store = Store::open_write(file_);
    store.forget({.object = 1}, store.begin_run("test", "{}"));
  }
  EXPECT_EQ(read_file(file_).find("HARIBO"), std::string::npos);
  const Store store = Store::open_read(file_);
  const auto kinds = pixel_kinds(store, store.scene(1));
  ASSERT_TRUE(kinds.has_value());
  EXPECT_EQ(kinds->pixels[2 * kWidth + 3], mapping::PixelKind::unmeasured) << "its shape is gone";
  EXPECT_EQ(kinds->pixels[0], mapping::PixelKind::map_explained);
  EXPECT_EQ(store.log(1).at(0).milliseconds, 12.5) << "how long it took says nothing of it";
  SQLite::Database database(file_.string());
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM blob WHERE media = 'depth/uint16-mm-delta'").getInt(),
            0);
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST_F(Kept, IsForgottenWithItsTime) {
  make();
  Store store = Store::open_write(file_);
  store.forget({.from = 150 * kSecond, .to = 250 * kSecond}, store.begin_run("test", "{}"));
  EXPECT_THAT(store.log(2), IsEmpty());
  EXPECT_FALSE(store.scene(2).pixel_kinds.has_value());
  EXPECT_EQ(store.log(3).size(), 2U);
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST_F(Kept, ComesAlongWhenMemoriesAreJoined) {
  make();
  const auto empty = folder_ / "empty.loci", joined = folder_ / "joined.loci", twice = folder_ / "twice.loci";
  { Store::open_write(empty); }
  NoProgress silent;
  merge(empty, file_, joined, FrameChange{}, silent);
  merge(joined, file_, twice, FrameChange{}, silent);
  const Store store = Store::open_read(twice);
  EXPECT_EQ(store.scenes().size(), 3U);
  EXPECT_EQ(store.log(2).size(), 2U);
  EXPECT_TRUE(pixel_kinds(store, store.scene(2)).has_value());
  EXPECT_EQ(cluster_points(store, store.scene(2), store.observation(2))->points.size(), 38U);
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST_F(Kept, RowsAreCountedAndAWrongCountIsFound) {
  make();
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    {
      SceneTransaction taken_back(store, run);
      taken_back.add_scene({.time = 1});
    }
    add_scene(store, run, 400 * kSecond);
  }
  SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
  const auto rows = [&](const std::string& table) {
    for (const Store::TableSize& size : Store::open_read(file_).statistics(false))
      if (size.table == table) return size.rows;
    return int64_t{-1};
  };
  for (const char* table :
       {"scene", "observation", "association", "blob", "scene_log", "reasoning", "belief", "stay"})
    EXPECT_EQ(rows(table), database.execAndGet(std::string("SELECT count(*) FROM ") + table).getInt64())
        << table;
  EXPECT_EQ(rows("scene"), 4);
  EXPECT_THAT(problems(Store::open_read(file_)), IsEmpty());
  database.exec("UPDATE row_count SET rows = 7 WHERE name = 'scene'");
  Store store = Store::open_write(file_);
  NoProgress silent;
  const VerifyReport report = store.verify(silent);
  EXPECT_THAT(report.problems, testing::ElementsAre(HasSubstr("scene has 4 rows, not the 7")));
  EXPECT_EQ(report.problems, report.derived_problems);
  store.derive();
  EXPECT_THAT(problems(store), IsEmpty());
}

TEST_F(Kept, KindsOfAnotherSizeAreFound) {
  make();
  SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
  database.exec("UPDATE scene SET depth_width = 9 WHERE id = 2");
  const Store store = Store::open_read(file_);
  EXPECT_THAT(problems(store), testing::Contains(HasSubstr("scene 2 has pixel kinds of another size")));
  EXPECT_THAT([&] { pixel_kinds(store, store.scene(2)); },
              testing::ThrowsMessage<Error>(HasSubstr("another size")));
}

}  // namespace
}  // namespace loci::memory
