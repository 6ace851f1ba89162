#include "memory/store/memory_file.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "mapping/base/files.h"
#include "memory/store/rows/merge.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

class MemoryFile : public testing_support::TemporaryFolder {
 protected:
  static void add_scene(Store& store, TimeNs time) {
    const Id run = store.begin_run("test", "{}");
    SceneTransaction scene(store, run);
    scene.add_scene({.time = time});
    scene.commit();
  }
  void make_memory(const fs::path& file, TimeNs time = 1000) {
    Store store = Store::open_write(file);
    add_scene(store, time);
  }
  static std::vector<TimeNs> times(const fs::path& file) {
    std::vector<TimeNs> result;
    for (const SceneRow& row : Store::open_read(file).scenes()) result.push_back(row.time);
    return result;
  }
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename().string());
    return names;
  }
  static unsigned mode_of(const fs::path& path) {
    return static_cast<unsigned>(fs::status(path).permissions()) & 0777U;
  }
  NoProgress silent_;
};

TEST_F(MemoryFile, IsPrivateWithItsLogAndItsCopies) {
  {
    Store store = Store::open_write(file_);
    add_scene(store, 1);
    EXPECT_EQ(mode_of(file_), 0600U);
    EXPECT_EQ(mode_of(file_.string() + "-wal"), 0600U);
  }
  backup_memory(file_, folder_ / "backup.loci", silent_);
  EXPECT_EQ(mode_of(folder_ / "backup.loci"), 0600U);
}

TEST_F(MemoryFile, HasOneWriterUnderAllItsNames) {
  make_memory(file_);
  const fs::path link = folder_ / "link.loci", hard = folder_ / "hard.loci";
  fs::create_symlink("memory.loci", link);
  {
    const Store writer = Store::open_write(file_);
    EXPECT_THAT([&] { Store::open_write(link); },
                ThrowsMessage<Error>(HasSubstr("another program is writing")));
    fs::create_hard_link(file_, hard);
    EXPECT_THAT([&] { Store::open_write(hard); }, ThrowsMessage<Error>(HasSubstr("2 names")));
  }
  EXPECT_THAT([&] { Store::open_write(file_); }, ThrowsMessage<Error>(HasSubstr("2 names")));
  fs::remove(hard);
  { const Store through_link = Store::open_write(link); }
  EXPECT_THAT(names(), testing::ElementsAre("link.loci", "memory.loci"));
}

TEST_F(MemoryFile, ALogOfAMemoryThatIsGoneIsNotReplayedIntoANewOne) {
  const auto leave_log = [&](const fs::path& file) {
    const Store writer = [&] {
      Store store = Store::open_write(file);
      add_scene(store, 77);
      return store;
    }();
    fs::copy_file(file.string() + "-wal", folder_ / "log", fs::copy_options::overwrite_existing);
  };
  const fs::path old = folder_ / "old.loci", fresh = folder_ / "fresh.loci", merged = folder_ / "merged.loci";
  leave_log(old);
  fs::copy_file(folder_ / "log", fresh.string() + "-wal");
  fs::copy_file(folder_ / "log", merged.string() + "-wal");
  make_memory(fresh, 5);
  EXPECT_THAT(times(fresh), testing::ElementsAre(5));
  make_memory(file_, 6);
  merge(fresh, file_, merged, FrameChange{}, silent_);
  EXPECT_THAT(times(merged), testing::ElementsAre(5, 6));
}

TEST_F(MemoryFile, IsBackedUpWhileAWriterIsAtWork) {
  Store writer = Store::open_write(file_);
  add_scene(writer, 1);
  const Id run = writer.begin_run("test", "{}");
  SceneTransaction unfinished(writer, run);
  unfinished.add_scene({.time = 2});
  const fs::path backup = folder_ / "backup.loci";
  const BackupResult result = backup_memory(file_, backup, silent_);
  EXPECT_THAT(result.report.problems, IsEmpty());
  EXPECT_EQ(result.bytes, static_cast<int64_t>(fs::file_size(backup)));
  EXPECT_THAT(times(backup), testing::ElementsAre(1));
  unfinished.commit();
  EXPECT_THAT(times(file_), testing::ElementsAre(1, 2));
  EXPECT_THAT([&] { backup_memory(file_, backup, silent_); },
              ThrowsMessage<Error>(HasSubstr("exists already")));
  EXPECT_THAT([&] { backup_memory(file_, file_, silent_); }, ThrowsMessage<Error>(HasSubstr("is an input")));
}

TEST_F(MemoryFile, IsRestoredWhereNobodyUsesIt) {
  const fs::path backup = folder_ / "backup.loci";
  make_memory(backup, 1);
  make_memory(file_, 2);
  EXPECT_THAT([&] { restore_memory(backup, file_, Replace::nothing, silent_); },
              ThrowsMessage<Error>(HasSubstr("exists already")));
  for (const bool writes : {false, true}) {
    const Store user = writes ? Store::open_write(file_) : Store::open_read(file_);
    EXPECT_EQ(user.scenes().size(), 1U);
    EXPECT_THAT([&] { restore_memory(backup, file_, Replace::anything, silent_); },
                ThrowsMessage<Error>(HasSubstr("another program is using this memory")));
  }
  EXPECT_THAT(times(file_), testing::ElementsAre(2));
  restore_memory(backup, file_, Replace::anything, silent_);
  EXPECT_THAT(times(file_), testing::ElementsAre(1));
  restore_memory(backup, folder_ / "new.loci", Replace::nothing, silent_);
  EXPECT_THAT(times(folder_ / "new.loci"), testing::ElementsAre(1));
  EXPECT_THAT(names(), testing::ElementsAre("backup.loci", "memory.loci", "new.loci"));
}

TEST_F(MemoryFile, IsRestoredOverAMemoryAlone) {
  const fs::path backup = folder_ / "backup.loci", letter = folder_ / "letter",
                 foreign = folder_ / "other.db";
  make_memory(backup, 1);
  make_memory(file_, 2);
  write_file_atomically(letter, "dear loci");
  SQLite::Database(foreign.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE t (x)");
  for (const fs::path& other : {letter, foreign}) {
    const std::string before = read_file(other);
    EXPECT_THAT([&] { restore_memory(backup, other, Replace::anything, silent_); },
                ThrowsMessage<Error>(HasSubstr("is no memory")));
    EXPECT_EQ(read_file(other), before);
  }
  fs::permissions(file_, fs::perms(0644));
  restore_memory(backup, file_, Replace::anything, silent_);
  EXPECT_EQ(mode_of(file_), 0600U);
}

TEST_F(MemoryFile, AFileThatIsCalledLikeItsLogStays) {
  make_memory(file_);
  for (const char* end : {"-wal", "-shm", "-journal"}) {
    const fs::path copy = folder_ / "copy.loci", neighbour = copy.string() + end;
    write_file_atomically(neighbour, "dear loci");
    EXPECT_THAT([&] { backup_memory(file_, copy, silent_); },
                ThrowsMessage<Error>(HasSubstr("is in the way")));
    EXPECT_THAT([&] { Store::open_write(copy); }, ThrowsMessage<Error>(HasSubstr("is in the way")));
    remove_side_files(copy);
    EXPECT_EQ(read_file(neighbour), "dear loci");
    fs::remove(neighbour);
  }
}

TEST_F(MemoryFile, ADamagedOneIsNeitherBackedUpNorRestored) {
  make_memory(file_);
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).exec("UPDATE scene_rank SET time = 7");
  const std::string before = read_file(file_);
  EXPECT_THAT([&] { backup_memory(file_, folder_ / "backup.loci", silent_); },
              ThrowsMessage<Error>(HasSubstr("problems")));
  EXPECT_THAT([&] { restore_memory(file_, folder_ / "new.loci", Replace::nothing, silent_); },
              ThrowsMessage<Error>(HasSubstr("problems")));
  EXPECT_THAT(names(), testing::ElementsAre("memory.loci"));
  EXPECT_EQ(read_file(file_), before);
}

TEST_F(MemoryFile, WhatFailsLeavesNoMemory) {
  make_memory(file_);
  EXPECT_THROW(create_atomically(folder_ / "new.loci", {file_},
                                 [&](const fs::path& made) {
                                   copy_memory(file_, made);
                                   const Store store = Store::open_write(made);
                                   throw Error("no");
                                 }),
               Error);
  EXPECT_THAT(names(), testing::ElementsAre("memory.loci"));
}

/// An object that stands on a table at a time and on a shelf at a later one.
struct Move {
  Id object = 0, table = 0, shelf = 0;
};

Move add_move(Store& store, TimeNs time, TimeNs later) {
  const Id run = store.begin_run("test", "{}");
  Move move;
  SceneTransaction first(store, run);
  move.table = first.add_place({.name = "table_1", .class_name = "table"});
  move.shelf = first.add_place({.name = "shelf_1", .class_name = "shelf"});
  const Id scene = first.add_scene({.time = time});
  move.object = first.add_object({});
  first.add_belief({.object = move.object,
                    .scene = scene,
                    .place = move.table,
                    .position = Vector3d(1, 0, 1),
                    .last_scene = scene});
  first.commit();
  SceneTransaction second(store, run);
  const Id moved = second.add_scene({.time = later});
  second.add_belief({.object = move.object,
                     .scene = moved,
                     .place = move.shelf,
                     .position = Vector3d(5, 0, 1),
                     .last_scene = moved});
  second.commit();
  return move;
}

TEST_F(MemoryFile, FindsObjectsAtTimesThatNeedMoreThan32Bits) {
  const TimeNs year_2050 = TimeNs{80} * 365 * 86400 * kSecond, later = year_2050 + 10 * kSecond;
  Store store = Store::open_write(file_);
  const auto [object, table, shelf] = add_move(store, year_2050, later);
  using testing::ElementsAre;
  EXPECT_THAT(store.objects_at(table, {.at = year_2050}), ElementsAre(object));
  EXPECT_THAT(store.objects_at(shelf, {.at = year_2050}), IsEmpty());
  EXPECT_THAT(store.objects_at(table, {.at = later}), IsEmpty());
  EXPECT_THAT(store.objects_at(shelf), ElementsAre(object));
  EXPECT_THAT(store.objects_at(table), IsEmpty());
  EXPECT_THAT(store.objects_near({1, 0, 1}, 0.5, {.at = year_2050}), ElementsAre(object));
  EXPECT_THAT(store.objects_near({5, 0, 1}, 0.5), ElementsAre(object));
  EXPECT_THAT(store.verify(silent_).problems, IsEmpty());
}

TEST_F(MemoryFile, FindsObjectsToTheNanosecond) {
  const TimeNs begin = 100 * kSecond, later = begin + 3 * kSecond + kSecond / 2;
  Store store = Store::open_write(file_);
  const auto [object, table, shelf] = add_move(store, begin, later);
  using testing::ElementsAre;
  for (const TimeNs before : {begin, begin + kSecond, later - 1}) {
    EXPECT_THAT(store.objects_at(table, {.at = before}), ElementsAre(object)) << before;
    EXPECT_THAT(store.objects_at(shelf, {.at = before}), IsEmpty()) << before;
  }
  EXPECT_THAT(store.objects_at(table, {.at = begin - 1}), IsEmpty());
  EXPECT_THAT(store.objects_at(table, {.at = later}), IsEmpty());
  EXPECT_THAT(store.objects_at(shelf, {.at = later}), ElementsAre(object));
}

}  // namespace
}  // namespace loci::memory
