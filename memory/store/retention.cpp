#include "memory/store/retention.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "mapping/base/json.h"
#include "memory/store/database.h"
#include "memory/store/schema.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

int64_t change(SQLite::Database& database, const std::string& text, TimeNs before) {
  SQLite::Statement statement(database, text);
  statement.bind(1, before);
  return statement.exec();
}

Json json_of(const std::optional<double>& seconds) {
  return seconds ? Json(*seconds) : Json();
}

}  // namespace

RetentionResult retain(const fs::path& memory, const RetentionRules& rules) {
  if (!rules.images_s && !rules.crops_s && !rules.reasoning_s)
    throw Error("nothing to let go of is named", {memory.string(), 0, {}}, "give an age");
  if (rules.images_s && rules.crops_s && *rules.crops_s < *rules.images_s)
    throw Error("crops would go before the images that they are of", {memory.string(), 0, {}},
                "keep crops at least as long as images");
  { const Store exists = Store::open_read(memory); }
  RetentionResult result;
  Store store = Store::open_write(memory);
  const std::optional<TimeNs> last = store.last_scene_time();
  if (!last) throw Error("the memory has no scene yet", {memory.string(), 0, {}});
  result.bytes_before = static_cast<int64_t>(fs::file_size(memory));
  const auto before = [&](double seconds) { return *last - static_cast<TimeNs>(seconds * double(kSecond)); };
  try {
    // Beside the store, whose lock keeps other writers out.
    SQLite::Database database(memory.string(), SQLite::OPEN_READWRITE);
    database.setBusyTimeout(5000);
    database.exec("PRAGMA secure_delete = ON");
    SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
    if (rules.images_s)
      result.scenes_without_images = change(
          database,
          "UPDATE scene SET image = NULL, depth = NULL, depth_width = NULL, depth_height = NULL, kinds = "
          "NULL WHERE time < ? AND (image IS NOT NULL OR depth IS NOT NULL)",
          before(*rules.images_s));
    // A cloud goes with the images, or with the mask that says where its points are.
    for (const std::optional<double>& age : {rules.images_s, rules.crops_s})
      if (age)
        result.observations_without_points +=
            change(database,
                   "UPDATE observation SET cloud = NULL WHERE cloud IS NOT NULL AND scene IN (SELECT id FROM "
                   "scene WHERE time < ?)",
                   before(*age));
    if (rules.crops_s) {
      result.observations_without_crops = change(
          database,
          "UPDATE observation SET crop = NULL, mask = NULL WHERE (crop IS NOT NULL OR mask IS NOT NULL) "
          "AND scene IN (SELECT id FROM scene WHERE time < ?)",
          before(*rules.crops_s));
      // What holds large arrays is no use without them.
      const std::string with_arrays =
          "feature_structure IN (SELECT l.feature_structure FROM feature_structure_blob l JOIN "
          "feature_structure "
          "f ON f.id = l.feature_structure JOIN scene s ON s.id = f.scene WHERE s.time < ?)";
      change(database, "UPDATE annotation SET feature_structure = NULL WHERE " + with_arrays,
             before(*rules.crops_s));
      database.exec("CREATE TEMP TABLE gone (id INTEGER PRIMARY KEY)");
      result.arrays =
          change(database,
                 "INSERT INTO temp.gone SELECT DISTINCT l.feature_structure FROM "
                 "feature_structure_blob l JOIN feature_structure f ON f.id = l.feature_structure JOIN "
                 "scene s ON s.id = f.scene WHERE s.time < ?",
                 before(*rules.crops_s));
      database.exec(
          "DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM temp.gone);"
          "DELETE FROM feature_structure WHERE id IN (SELECT id FROM temp.gone); DROP TABLE temp.gone");
    }
    if (rules.reasoning_s) {
      // The row stays and is empty, so that it is known that it was let go.
      result.scenes_without_reasoning =
          change(database,
                 "UPDATE reasoning SET encoding = 0, content = x'' WHERE length(content) > 0 AND scene IN "
                 "(SELECT id FROM scene WHERE time < ?)",
                 before(*rules.reasoning_s));
    }
    database.exec(kDropUnusedBlobs);
    database.exec(kCounting);
    all.commit();
    database.exec("VACUUM");
    database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
  } catch (const SQLite::Exception& error) {
    throw_database_error(error, memory);
  }
  result.bytes_after = static_cast<int64_t>(fs::file_size(memory));
  store.finish_run(store.begin_run("loci-memory retain",
                                   Json{{"images_s", json_of(rules.images_s)},
                                        {"crops_s", json_of(rules.crops_s)},
                                        {"reasoning_s", json_of(rules.reasoning_s)},
                                        {"scenes_without_images", result.scenes_without_images},
                                        {"observations_without_crops", result.observations_without_crops},
                                        {"observations_without_points", result.observations_without_points},
                                        {"scenes_without_reasoning", result.scenes_without_reasoning},
                                        {"arrays", result.arrays}}
                                       .dump()));
  return result;
}

}  // namespace loci::memory
