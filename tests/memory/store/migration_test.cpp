// The mechanism of migrations, with an example: a minor version that adds a column.

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "mapping/base/json.h"
#include "memory/store/format.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

const Migration kExample[] = {{kMemoryFormat.version + 1, "ALTER TABLE recording ADD COLUMN robot TEXT",
                               "CREATE TEMP VIEW recording AS SELECT *, NULL AS robot FROM main.recording"}};
const Migration kBroken[] = {
    {kMemoryFormat.version + 1, "ALTER TABLE recording ADD COLUMN robot TEXT; DROP TABLE no_such_table", ""}};

MemoryFormat with(std::span<const Migration> migrations) {
  return {kMemoryFormat.version + 1, kMemoryFormat.schema, migrations};
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
