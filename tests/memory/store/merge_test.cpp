#include "memory/store/rows/merge.h"
#include "mapping/base/math/math.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "mapping/base/files.h"
#include "memory/store/erasure/retention.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

const std::vector<std::string> kTables = {
    "run",         "recording",  "place",  "scene",       "observation",
    "term",        "annotation", "object", "association", "event",
    "belief",      "visibility", "fact",   "blob",        "observation_rank",
    "object_term", "stay"};

class MergeTest : public testing_support::TemporaryFolder {
 protected:
  /// A robot that looks at one thing on a table, once per time, and is told what it is.
  fs::path robot(const std::string& name, const Vector3d& at, const std::vector<TimeNs>& times,
                 const std::string& recording) {
    const fs::path file = folder_ / (name + ".loci");
    Store store = Store::open_write(file, {.now = 99});
    const Id run = store.begin_run("robot " + name, "{}");
    const Id source = store.add_recording({.fingerprint = recording, .name = name, .kind = "loci"});
    Id object = 0;
    for (size_t i = 0; i < times.size(); ++i) {
      SceneTransaction scene(store, run);
      const Id table = scene.add_place({.name = "table_1",
                                        .class_name = "table",
                                        .height = at.z(),
                                        .outline = {{at.x() - 1, at.y() - 1}, {at.x() + 1, at.y() + 1}}});
      const Id image = scene.add_blob("image of " + name + std::to_string(times[i]), "image/jpeg");
      const Id id = scene.add_scene({.recording = source,
                                     .frame_index = static_cast<int64_t>(i),
                                     .time = times[i],
                                     .map_from_camera = Isometry3d(Eigen::Translation3d(at)),
                                     .image = image});
      if (object == 0) object = scene.add_object({});
      const Id seen = scene.add_observation({.scene = id,
                                             .number = 0,
                                             .place = table,
                                             .position = at,
                                             .crop = scene.add_blob("crop of " + name, "image/png")});
      scene.add_annotation({.scene = id, .observation = seen, .type = "loci.Class", .value = name});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = object,
                             .explanation = i == 0 ? Explanation::appear : Explanation::stay,
                             .probability = 0.9,
                             .chosen = true});
      scene.add_belief({.object = object,
                        .scene = id,
                        .status = ObjectStatus::seen,
                        .place = table,
                        .position = at,
                        .last_scene = id,
                        .last_observation = seen});
      scene.add_visibility({0, id, std::nullopt, table, ObjectStatus::seen, std::nullopt, 1.0});
      scene.commit();
    }
    store.add_fact({.object = object, .key = "owner", .value = name, .clock = {.valid_from = 1}}, run);
    store.finish_run(run);
    return file;
  }

  std::map<std::string, int64_t> rows(const fs::path& file) const {
    std::map<std::string, int64_t> rows;
    SQLite::Database database(file.string());
    for (const std::string& table : kTables)
      rows[table] = database.execAndGet("SELECT count(*) FROM " + table).getInt64();
    return rows;
  }

  std::vector<std::string> problems(const fs::path& file) {
    NoProgress quiet;
    return Store::open_read(file).verify(quiet).problems;
  }

  NoProgress quiet_;
  const FrameChange same_frame_;
};

TEST_F(MergeTest, JoinsTwoRobotsWithoutLoss) {
  const fs::path a = robot("ada", {1, 0, 0.8}, {1000, 3000}, "rec a");
  const fs::path b = robot("ben", {1, 0, 0.8}, {2000, 4000, 5000}, "rec b");
  const fs::path out = folder_ / "both.loci";
  const MergeResult result = merge(a, b, out, same_frame_, quiet_);
  EXPECT_EQ(result.scenes, 3);
  EXPECT_EQ(result.observations, 3);
  EXPECT_EQ(result.objects, 1);
  EXPECT_EQ(result.facts, 1);
  EXPECT_THAT(problems(out), IsEmpty());
  const auto of_a = rows(a), of_b = rows(b);
  auto both = rows(out);
  for (const char* table :
       {"scene", "observation", "object", "association", "belief", "visibility", "fact", "blob"})
    EXPECT_EQ(both[table], of_a.at(table) + of_b.at(table)) << table;
  EXPECT_EQ(both["place"], 1);
  const Store store = Store::open_read(out);
  ASSERT_EQ(store.observations_of(2).size(), 3U);
  EXPECT_EQ(store.observations_of(2)[1].time, 4000);
  EXPECT_EQ(store.objects_annotated("ben"), std::vector<Id>{2});
  EXPECT_EQ(store.facts().back().object, 2);
}

TEST_F(MergeTest, AddsNothingTheSecondTime) {
  const fs::path a = robot("ada", {1, 0, 0.8}, {1000, 3000}, "rec a");
  const fs::path b = robot("ben", {1, 0, 0.8}, {2000, 4000}, "rec b");
  merge(a, b, folder_ / "once.loci", same_frame_, quiet_);
  const MergeResult again = merge(folder_ / "once.loci", b, folder_ / "twice.loci", same_frame_, quiet_);
  EXPECT_EQ(again.scenes, 0);
  EXPECT_EQ(again.known_scenes, 2);
  EXPECT_EQ(again.objects, 0);
  EXPECT_EQ(rows(folder_ / "once.loci"), rows(folder_ / "twice.loci"));
  merge(a, a, folder_ / "itself.loci", std::nullopt, quiet_);
  EXPECT_EQ(rows(a), rows(folder_ / "itself.loci"));
}

TEST_F(MergeTest, RefusesFramesThatAreNotKnownToBeOne) {
  const fs::path a = robot("ada", {1, 0, 0.8}, {1000}, "rec a");
  const fs::path b = robot("ben", {1, 0, 0.8}, {2000}, "rec b");
  const fs::path out = folder_ / "both.loci";
  EXPECT_THAT([&] { merge(a, b, out, std::nullopt, quiet_); },
              ThrowsMessage<Error>(HasSubstr("not known to be in one map frame")));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_FALSE(fs::exists(folder_ / "both.loci.partial"));
}

TEST_F(MergeTest, BringsTheSecondIntoTheFirstOnesFrame) {
  const fs::path a = robot("ada", {1, 0, 0.8}, {1000}, "rec a");
  const fs::path b = robot("ben", {2, 0, 0.8}, {2000}, "rec b");
  const fs::path out = folder_ / "both.loci";
  const FrameChange frame{Vector3d(10, 20, 0.5), kPi / 2};
  const MergeResult result = merge(a, b, out, frame, quiet_);
  ASSERT_EQ(result.renamed.size(), 1U) << "another table of the same name";
  EXPECT_THAT(problems(out), IsEmpty());
  const Store store = Store::open_read(out);
  EXPECT_TRUE(store.beliefs().back().position->isApprox(Vector3d(10, 22, 1.3), 1e-9));
  const Isometry3d camera = *store.scene(2).map_from_camera;
  EXPECT_TRUE(camera.translation().isApprox(Vector3d(10, 22, 1.3), 1e-9));
  EXPECT_TRUE((camera.linear() * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-9));
  const PlaceRow place = store.places().back();
  EXPECT_EQ(place.name, "table_1_2");
  EXPECT_NEAR(*place.height, 1.3, 1e-9);
  EXPECT_NEAR(place.outline.front().x(), 11, 1e-9);
  EXPECT_NEAR(place.outline.front().y(), 21, 1e-9);
  merge(out, b, folder_ / "again.loci", frame, quiet_);
  EXPECT_EQ(rows(out), rows(folder_ / "again.loci"));
}

TEST_F(MergeTest, OldImagesGoAndNumbersStay) {
  const fs::path file = robot("ada", {1, 0, 0.8}, {0, 100 * kSecond, 200 * kSecond}, "rec a");
  const RetentionResult result = retain(file, {.images_s = 50, .crops_s = 150});
  EXPECT_EQ(result.scenes_without_images, 2);
  EXPECT_EQ(result.observations_without_crops, 1);
  EXPECT_THAT(problems(file), IsEmpty());
  const std::string bytes = read_file(file);
  EXPECT_EQ(bytes.find("image of ada0"), std::string::npos);
  EXPECT_NE(bytes.find("image of ada200"), std::string::npos);
  EXPECT_NE(bytes.find("crop of ada"), std::string::npos) << "younger observations have the same crop";
  const Store store = Store::open_read(file);
  EXPECT_EQ(store.observations_of(1).size(), 3U);
  EXPECT_EQ(store.runs().back().program, "loci-memory retain") << "it is logged";
  EXPECT_THAT(store.runs().back().configuration, HasSubstr("\"scenes_without_images\":2"));
  for (const RetentionRules& rules : {RetentionRules{.images_s = 9, .crops_s = 1}, {.crops_s = 1}})
    EXPECT_THAT([&] { retain(file, rules); }, ThrowsMessage<Error>(HasSubstr("crops would go before")));
}

TEST_F(MergeTest, WhatIsNotSoundGetsNoName) {
  const fs::path a = robot("ada", {1, 0, 0.8}, {1000, 3000}, "rec a");
  const fs::path b = robot("ben", {1, 0, 0.8}, {2000, 4000}, "rec b");
  {
    SQLite::Database database(b.string(), SQLite::OPEN_READWRITE);
    database.exec(
        "INSERT INTO association (scene, observation, object, explanation, probability, chosen, valid_from, "
        "known_from, run, source) SELECT scene, observation, object, explanation, probability, chosen, "
        "valid_from, known_from, run, source FROM association WHERE id = 1");
  }
  const fs::path out = folder_ / "both.loci";
  EXPECT_THAT([&] { merge(a, b, out, same_frame_, quiet_); }, ThrowsMessage<Error>(HasSubstr("problems")));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace loci::memory
