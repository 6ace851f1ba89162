// The mechanism of migrations, with an example: a minor version that adds a column.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "mapping/base/text/json.h"
#include "memory/store/format.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

const Migration kExample[] = {{kMemoryFormat.version + 1, "ALTER TABLE recording ADD COLUMN robot TEXT",
                               "CREATE TEMP VIEW recording AS SELECT *, NULL AS robot FROM main.recording",
                               "ALTER TABLE recording DROP COLUMN robot"}};
const Migration kBroken[] = {{kMemoryFormat.version + 1,
                              "ALTER TABLE recording ADD COLUMN robot TEXT; DROP TABLE no_such_table", "",
                              "ALTER TABLE recording DROP COLUMN robot"}};
/// The migration leaves another schema than the version has.
const Migration kIncomplete[] = {
    {kMemoryFormat.version + 1, "SELECT 1", "", "ALTER TABLE recording DROP COLUMN robot"}};

/// A later version, in which recordings name their robot.
MemoryFormat with(std::span<const Migration> example) {
  static const std::string schema = [] {
    std::string text = kMemoryFormat.schema;
    const std::string last = "  frames INTEGER ";
    text.replace(text.find(last), last.size(), "  frames INTEGER, robot TEXT ");
    return text;
  }();
  static std::vector<std::vector<Migration>> kept;  // formats refer to them
  std::vector<Migration>& all =
      kept.emplace_back(kMemoryFormat.migrations.begin(), kMemoryFormat.migrations.end());
  all.insert(all.end(), example.begin(), example.end());
  return {kMemoryFormat.version + 1, schema.c_str(), all};
}

class MigrationTest : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    const Id recording = store.add_recording({.fingerprint = "abc", .name = "day", .kind = "loci"});
    SceneTransaction scene(store, run);
    scene.add_scene({.recording = recording, .frame_index = 0, .time = 1000});
    scene.commit();
  }

  int64_t number(const std::string& query) {
    return SQLite::Database(file_.string()).execAndGet(query).getInt64();
  }

  /// What a program of any version reads.
  void expect_content(const Store& store) {
    ASSERT_EQ(store.recordings().size(), 1U);
    EXPECT_EQ(store.recordings()[0].name, "day");
    EXPECT_EQ(store.frames(1), (std::set<int64_t>{0}));
    NoProgress silent;
    EXPECT_THAT(store.verify(silent).problems, IsEmpty());
  }
};

TEST_F(MigrationTest, ReadingAnOlderMinorVersionChangesNothing) {
  const std::string before = read_file(file_);
  {
    const Store store = Store::open_read(file_, with(kExample));
    EXPECT_EQ(store.minor(), kMemoryFormat.minor());
    expect_content(store);
    store.read_view("v_scenes", [](const Json&) {});
  }
  EXPECT_EQ(read_file(file_), before);
}

TEST_F(MigrationTest, WritingMigratesOnce) {
  { Store::open_write(file_, {}, with(kExample)); }
  EXPECT_EQ(number("PRAGMA user_version"), kMemoryFormat.version + 1);
  EXPECT_EQ(number("SELECT count(*) FROM recording WHERE robot IS NULL"), 1);
  Store again = Store::open_write(file_, {}, with(kExample));
  expect_content(again);
}

TEST_F(MigrationTest, AMigratedMemoryIsReadButNotWrittenByTheOlderProgram) {
  { Store::open_write(file_, {}, with(kExample)); }
  expect_content(Store::open_read(file_));
  EXPECT_THAT([&] { Store::open_write(file_); }, ThrowsMessage<Error>(HasSubstr("it can only be read")));
}

TEST_F(MigrationTest, AMigrationThatFailsLeavesTheMemoryAsItWas) {
  EXPECT_THROW(Store::open_write(file_, {}, with(kBroken)), Error);
  EXPECT_EQ(number("PRAGMA user_version"), kMemoryFormat.version);
  expect_content(Store::open_write(file_));
}

TEST_F(MigrationTest, WhatWasThereBeforeIsKeptBeside) {
  fs::path kept;
  { kept = Store::open_write(file_, {}, with(kExample)).kept_before_migration(); }
  EXPECT_EQ(kept.string(),
            file_.string() + fmt::format(".{}.{}", kMemoryFormat.major(), kMemoryFormat.minor()));
  EXPECT_EQ(fs::status(kept).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  expect_content(Store::open_write(kept));
  EXPECT_THAT(Store::open_write(file_, {}, with(kExample)).kept_before_migration().string(), IsEmpty());
}

TEST_F(MigrationTest, AMigrationThatMakesAnotherSchemaIsTakenBack) {
  EXPECT_THROW(Store::open_write(file_, {}, with(kIncomplete)), Error);
  expect_content(Store::open_write(file_));
}

TEST_F(MigrationTest, ViewsAndTriggersOfANewerVersionAreNeverRun) {
  { Store::open_write(file_, {}, with(kExample)); }
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec(
          "DROP VIEW v_scenes; CREATE VIEW v_scenes AS SELECT 'planted' AS scene; DROP VIEW "
          "association_known;"
          "CREATE VIEW association_known AS SELECT 'planted' AS object");
  const Store store = Store::open_read(file_);
  expect_content(store);
  store.read_view("v_scenes", [](const Json& row) { EXPECT_EQ(row["scene"], 1); });
  EXPECT_THROW(store.read_view("v_planted", [](const Json&) {}), Error);
}

TEST_F(MigrationTest, ANewerVersionWithAnotherKindOfTableIsRefused) {
  { Store::open_write(file_, {}, with(kExample)); }
  for (const char* change : {"DROP TABLE recording; CREATE VIEW recording AS SELECT 1 AS id",
                             "ALTER TABLE recording RENAME COLUMN name TO title", "DROP TABLE recording"}) {
    const fs::path changed = folder_ / "changed.loci";
    fs::copy_file(file_, changed, fs::copy_options::overwrite_existing);
    SQLite::Database(changed.string(), SQLite::OPEN_READWRITE)
        .exec(std::string("PRAGMA foreign_keys = OFF; PRAGMA legacy_alter_table = ON;") + change);
    EXPECT_THAT([&] { Store::open_read(changed); }, ThrowsMessage<Error>(HasSubstr("'recording'"))) << change;
  }
}

TEST_F(MigrationTest, AMemoryOfADevelopmentVersionIsRefused) {
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec("PRAGMA application_id = " + std::to_string(kDevelopmentApplicationId) +
            "; PRAGMA user_version = 1005");
  const auto refused = ThrowsMessage<Error>(testing::AllOf(HasSubstr("development version of loci"),
                                                           HasSubstr("run loci-perceive again"),
                                                           testing::Not(HasSubstr("\n"))));
  EXPECT_THAT([&] { Store::open_read(file_); }, refused);
  EXPECT_THAT([&] { Store::open_write(file_); }, refused);
}

}  // namespace
}  // namespace loci::memory
