// What goes by age, and how a memory is rewritten so that nothing of what was removed remains in its file.

#include "memory/store/erasure/retention.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "mapping/base/output_file.h"
#include "mapping/base/text/json.h"
#include "mapping/base/time_limits.h"
#include "memory/store/memory_file.h"
#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/row_columns.h"

namespace loci::memory {
namespace {

/// Images, depth thumbnails with their pixel kinds, and clouds.
void discard_images(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.scenes_without_images =
      run_statements(database,
                     "UPDATE scene SET image = NULL, depth = NULL, depth_width = NULL, "
                     "depth_height = NULL, pixel_kinds = NULL "
                     "WHERE time < ? AND (image IS NOT NULL OR depth IS NOT NULL);",
                     {sql(before)});
}

/// Without the images, or without the mask, a cloud is of no use.
void discard_clouds(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.observations_without_points += run_statements(
      database,
      "UPDATE observation SET cloud = NULL WHERE cloud IS NOT NULL AND scene IN (SELECT id FROM scene WHERE "
      "time < ?);",
      {sql(before)});
}

/// Crops, masks, and feature structures with large arrays.
void discard_crops(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.observations_without_crops = run_statements(database,
                                                     "UPDATE observation SET crop = NULL, mask = NULL WHERE "
                                                     "(crop IS NOT NULL OR mask IS NOT NULL) AND scene IN "
                                                     "(SELECT id FROM scene WHERE time < ?);",
                                                     {sql(before)});
  database.exec("CREATE TEMP TABLE gone (id INTEGER PRIMARY KEY)");
  result.arrays = run_statements(
      database,
      "INSERT INTO temp.gone SELECT DISTINCT l.feature_structure FROM feature_structure_blob l JOIN "
      "feature_structure f ON f.id = l.feature_structure JOIN scene s ON s.id = f.scene WHERE s.time < ?;",
      {sql(before)});
  database.exec(
      "UPDATE annotation SET feature_structure = NULL WHERE feature_structure IN (SELECT id FROM temp.gone);"
      "DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM temp.gone);"
      "DELETE FROM feature_structure WHERE id IN (SELECT id FROM temp.gone); DROP TABLE temp.gone");
}

/// The row remains, empty: it was discarded.
void discard_reasoning(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.scenes_without_reasoning = run_statements(
      database,
      "UPDATE reasoning SET encoding = 0, content = x'' WHERE length(content) > 0 AND scene IN "
      "(SELECT id FROM scene WHERE time < ?);",
      {sql(before)});
}

std::string configuration_text(const RetentionRules& rules, const RetentionResult& result) {
  const auto json_of = [](const std::optional<double>& seconds) { return seconds ? Json(*seconds) : Json(); };
  return Json{{"images_s", json_of(rules.images_s)},
              {"crops_s", json_of(rules.crops_s)},
              {"reasoning_s", json_of(rules.reasoning_s)},
              {"scenes_without_images", result.scenes_without_images},
              {"observations_without_crops", result.observations_without_crops},
              {"observations_without_points", result.observations_without_points},
              {"scenes_without_reasoning", result.scenes_without_reasoning},
              {"arrays", result.arrays}}
      .dump();
}

/// Keeps out readers too, until the database is closed. Error while there are any.
void keep_readers_out(SQLite::Database& database, const std::filesystem::path& memory) {
  try {
    // To leave the mode of the write-ahead log, one must be alone.
    database.setBusyTimeout(0);
    database.exec("PRAGMA locking_mode = EXCLUSIVE");
    if (database.execAndGet("PRAGMA journal_mode = DELETE").getString() != "delete")
      throw SQLite::Exception("readers", SQLITE_BUSY);
    database.exec("BEGIN EXCLUSIVE; COMMIT");
  } catch (const SQLite::Exception& error) {
    if ((error.getErrorCode() & 0xff) != SQLITE_BUSY && (error.getErrorCode() & 0xff) != SQLITE_LOCKED) throw;
    throw Error("another program is reading this memory: what is erased would stay in its file",
                {memory.string(), 0, {}}, "close it first, or write a new memory with -o");
  }
}

/// A file that nobody else can read.
const std::filesystem::path& create_empty(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0)
    throw Error(std::string("cannot be written: ") + std::strerror(errno), {path.string(), 0, {}});
  ::close(descriptor);
  return path;
}

/// Whether what was written will survive a loss of power.
bool sync_to_disk(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = ::fsync(descriptor) == 0;
  ::close(descriptor);
  return synced;
}

}  // namespace

void overwrite_deleted(SQLite::Database& database) {
  database.exec("VACUUM");
  database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
}

void rewrite_memory(const std::filesystem::path& memory, const std::filesystem::path& output,
                    const std::function<void(Store&)>& change) {
  { const Store exists = Store::open_read(memory); }
  const auto changed = [&](const std::filesystem::path& copy) {
    {
      Store store = Store::open_write(copy, {.keep_before_migration = false});
      change(store);
    }
    require_no_log(copy);
    if (!sync_to_disk(copy, O_RDONLY))
      throw Error(std::string("cannot be written: ") + std::strerror(errno), {copy.string(), 0, {}},
                  kMakeRoom);
  };
  if (!output.empty()) {
    create_atomically(output, {memory}, [&](const std::filesystem::path& copy) {
      copy_memory(memory, copy);
      changed(copy);
    });
    return;
  }
  const std::filesystem::path target = std::filesystem::canonical(memory);
  // Its lock keeps out other writers until the end. A copy beside would keep what is to be erased.
  Store store = Store::open_write(target, {.keep_before_migration = false});
  Store::Connection& db = *store.connection_;
  const PartialMemory copy(target);
  const auto restore = [&] {
    if (!db.database) return;
    db.database->tryExec("PRAGMA locking_mode = NORMAL");
    db.database->tryExec("PRAGMA journal_mode = WAL");
    db.database->tryExec("SELECT count(*) FROM meta");
  };
  try {
    db.guarded([&] {
      db.statements.clear();
      keep_readers_out(*db.database, memory);
      std::filesystem::permissions(create_empty(copy.path()), std::filesystem::status(target).permissions());
      SQLite::Statement into(*db.database, "VACUUM INTO ?");
      into.bind(1, copy.path().string());
      into.exec();
    });
    reported_of(memory, copy.path(), [&] { changed(copy.path()); });
  } catch (...) {
    restore();
    throw;
  }
  db.database.reset();  // before the new file has its name: closing removes logs by name
  std::filesystem::rename(copy.path(), target);
  sync_to_disk(target.parent_path(), O_RDONLY | O_DIRECTORY);
}

RetentionResult Store::retain(const RetentionRules& rules) {
  auto& db = *connection_;
  db.require_writable();
  RetentionResult result;
  const std::optional<TimeNs> last = last_scene_time();
  if (!last) throw error("the memory has no scene yet");
  db.guarded([&] {
    SQLite::Database& database = *db.database;
    db.statements.clear();
    db.clear_caches();
    database.exec("PRAGMA secure_delete = ON");
    SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
    const auto discard = [&](const std::optional<double>& age_s, auto what) {
      if (!age_s || *age_s * double(kSecond) >= double(kMaxTime)) return;  // nothing is so old
      what(database, *last - static_cast<TimeNs>(*age_s * double(kSecond)), result);
    };
    discard(rules.images_s, discard_images);
    discard(rules.images_s, discard_clouds);
    discard(rules.crops_s, discard_clouds);
    discard(rules.crops_s, discard_crops);
    discard(rules.reasoning_s, discard_reasoning);
    drop_unused_blobs(database);
    count_rows(database);
    all.commit();
    overwrite_deleted(database);
  });
  finish_run(begin_run("loci-memory retain", configuration_text(rules, result)));
  return result;
}

RetentionResult retain(const std::filesystem::path& memory, const RetentionRules& rules,
                       const std::filesystem::path& output) {
  if (!rules.images_s && !rules.crops_s && !rules.reasoning_s)
    throw Error("nothing to discard is named", {memory.string(), 0, {}}, "give an age");
  if (rules.crops_s && (!rules.images_s || *rules.crops_s < *rules.images_s))
    throw Error("crops would go before the images that they are of", {memory.string(), 0, {}},
                "keep images for a time (--keep-images), and crops at least as long");
  std::error_code missing;
  const auto bytes_before = static_cast<int64_t>(std::filesystem::file_size(memory, missing));
  RetentionResult result;
  rewrite_memory(memory, output, [&](Store& store) { result = store.retain(rules); });
  result.bytes_before = bytes_before;
  result.bytes_after = static_cast<int64_t>(std::filesystem::file_size(output.empty() ? memory : output));
  return result;
}

}  // namespace loci::memory
