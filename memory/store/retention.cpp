// What is removed from a memory for good: on request (forget) or by age (retain). The bytes are gone from the
// file and its log; that something was forgotten remains known.

#include "memory/store/retention.h"

#include "mapping/base/json.h"
#include "memory/store/derived_rows.h"
#include "memory/store/row_columns.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

// What is erased, in temporary tables: observations, objects of which nothing remains, scenes whose images
// are erased.
constexpr const char* kEraseObject = R"sql(
INSERT INTO temp.gone_object VALUES (?1);
INSERT INTO temp.gone_observation SELECT DISTINCT observation FROM association
  WHERE object = ?1 AND chosen = 1 AND observation IS NOT NULL;
INSERT INTO temp.gone_image SELECT DISTINCT o.scene FROM temp.gone_observation g JOIN observation o ON o.id = g.id;
)sql";

constexpr const char* kEraseInterval = R"sql(
INSERT INTO temp.gone_image SELECT id FROM scene WHERE time BETWEEN ?1 AND ?2;
INSERT INTO temp.gone_observation SELECT o.id FROM observation o JOIN temp.gone_image g ON g.id = o.scene;
INSERT INTO temp.gone_object SELECT id FROM object o WHERE
  EXISTS (SELECT 1 FROM association a WHERE a.object = o.id AND a.observation IN (SELECT id FROM temp.gone_observation))
  AND NOT EXISTS (SELECT 1 FROM association a WHERE a.object = o.id AND a.chosen = 1 AND a.observation IS NOT NULL
    AND a.observation NOT IN (SELECT id FROM temp.gone_observation));
DELETE FROM association WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM event WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM visibility WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM belief WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM annotation WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM feature_structure
  WHERE scene IN (SELECT id FROM temp.gone_image));
DELETE FROM feature_structure WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM scene_log WHERE scene IN (SELECT id FROM temp.gone_image);
UPDATE scene SET depth = NULL, depth_width = NULL, depth_height = NULL, pixel_kinds = NULL, joints = NULL, x = NULL, y = NULL, z = NULL,
  qx = NULL, qy = NULL, qz = NULL, qw = NULL WHERE id IN (SELECT id FROM temp.gone_image);
)sql";

constexpr const char* kEraseReferences = R"sql(
DELETE FROM association WHERE object IN (SELECT id FROM temp.gone_object)
  OR observation IN (SELECT id FROM temp.gone_observation);
DELETE FROM event WHERE object IN (SELECT id FROM temp.gone_object)
  OR observation IN (SELECT id FROM temp.gone_observation);
DELETE FROM belief WHERE object IN (SELECT id FROM temp.gone_object);
DELETE FROM visibility WHERE object IN (SELECT id FROM temp.gone_object);
DELETE FROM fact WHERE object IN (SELECT id FROM temp.gone_object);
UPDATE belief SET last_observation = NULL, last_scene = NULL
  WHERE last_observation IN (SELECT id FROM temp.gone_observation);
DELETE FROM annotation WHERE observation IN (SELECT id FROM temp.gone_observation);
DELETE FROM reasoning WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM feature_structure
  WHERE observation IN (SELECT id FROM temp.gone_observation));
DELETE FROM feature_structure WHERE observation IN (SELECT id FROM temp.gone_observation);
DELETE FROM observation WHERE id IN (SELECT id FROM temp.gone_observation);
UPDATE scene_log SET text = NULL WHERE scene IN (SELECT id FROM temp.gone_image);
UPDATE scene SET image = NULL WHERE id IN (SELECT id FROM temp.gone_image);
DELETE FROM term WHERE id NOT IN (SELECT term FROM annotation);
)sql";

/// Runs several statements; each is bound to as many of the values as it has parameters. Returns the rows
/// changed.
int64_t run_all(SQLite::Database& database, const std::string& text, const SqlValues& values) {
  int64_t changed = 0;
  for (size_t begin = 0, end = 0; (end = text.find(';', begin)) != std::string::npos; begin = end + 1) {
    SQLite::Statement statement(database, text.substr(begin, end - begin + 1));
    const auto count = static_cast<std::ptrdiff_t>(
        std::min(static_cast<size_t>(statement.getBindParameterCount()), values.size()));
    bind_values(statement, {values.begin(), values.begin() + count});
    changed += statement.exec();
  }
  return changed;
}

/// Removes blobs that no column refers to.
void drop_unused_blobs(SQLite::Database& database) {
  SQLite::Statement references(
      database,
      "SELECT t.name, f.\"from\" FROM sqlite_schema t, pragma_foreign_key_list(t.name) f WHERE "
      "t.type = 'table' AND f.\"table\" = 'blob'");
  std::string used;
  while (references.executeStep())
    used += fmt::format("{0}SELECT {2} FROM {1} WHERE {2} IS NOT NULL", used.empty() ? "" : " UNION ",
                        references.getColumn(0).getString(), references.getColumn(1).getString());
  database.exec(fmt::format("DELETE FROM blob WHERE id NOT IN ({})", used));
}

/// The region of a scene's depth thumbnail that an erased observation covers.
struct ErasedRegion {
  Id scene = 0;
  int64_t width = 0, height = 0;  ///< of the thumbnail
  std::optional<std::array<double, 4>>
      sides;  ///< left, top, right, bottom, pixels; unset = unknown: all of it

  bool contains(int64_t x, int64_t y) const {
    const auto& [left, top, right, bottom] = *sides;
    const auto u = static_cast<double>(x), v = static_cast<double>(y);
    return u >= left && u <= right && v >= top && v <= bottom;
  }
};

/// The regions of interest, enlarged by a pixel.
std::vector<ErasedRegion> erased_regions(Store::Connection& db) {
  std::vector<ErasedRegion> regions;
  db.query(
      "SELECT o.scene, s.depth_width, s.depth_height, s.camera_width, s.camera_height, o.roi_x, o.roi_y, "
      "o.roi_width, "
      "o.roi_height FROM temp.gone_observation g JOIN observation o ON o.id = g.id JOIN scene s ON s.id = "
      "o.scene "
      "WHERE s.depth IS NOT NULL ORDER BY o.id",
      {}, [&](const SqlRow& row) {
        ErasedRegion region{row.get<Id>("scene"), row.get<int64_t>("depth_width"),
                            row.get<int64_t>("depth_height"), std::nullopt};
        if (!row.is_null("roi_x") && !row.is_null("camera_width")) {
          const double sx = double(region.width) / row.get<double>("camera_width"),
                       sy = double(region.height) / row.get<double>("camera_height");
          const auto x = row.get<double>("roi_x"), y = row.get<double>("roi_y");
          region.sides = {x * sx - 1, y * sy - 1, (x + row.get<double>("roi_width")) * sx + 1,
                          (y + row.get<double>("roi_height")) * sy + 1};
        }
        regions.push_back(region);
      });
  return regions;
}

/// Sets a region to 0 in an image of a scene: the blob of a column, with so many bytes per pixel.
void erase_region(Store::Connection& db, const ErasedRegion& region, const std::string& column,
                  const char* media, size_t pixel_bytes) {
  std::optional<Id> rest;
  if (region.sides) {
    std::string bytes;
    db.query(
        fmt::format(
            "SELECT b.encoding, b.content, b.size FROM scene s JOIN blob b ON b.id = s.{} WHERE s.id = ?",
            column),
        {sql(region.scene)}, [&](const SqlRow& row) {
          bytes = decode_bytes(row.bytes("content"), row.get<int64_t>("encoding"), row.get<int64_t>("size"),
                               db.path);
        });
    if (bytes.empty()) return;
    for (int64_t y = 0; y < region.height; ++y)
      for (int64_t x = 0; x < region.width; ++x) {
        const size_t at = pixel_bytes * static_cast<size_t>(y * region.width + x);
        if (region.contains(x, y) && at + pixel_bytes <= bytes.size())
          bytes.replace(at, pixel_bytes, pixel_bytes, '\0');
      }
    rest = db.add_blob(bytes, media);
  }
  db.run(fmt::format("UPDATE scene SET {} = ?1 WHERE id = ?2", column), {sql(rest), sql(region.scene)});
}

void erase_from_depth(Store::Connection& db) {
  for (const ErasedRegion& region : erased_regions(db)) {
    erase_region(db, region, "depth", kDepthThumbnailMedia, 2);
    erase_region(db, region, "pixel_kinds", kPixelKindsMedia, 1);
    if (!region.sides)
      db.run("UPDATE scene SET depth_width = NULL, depth_height = NULL WHERE id = ?", {sql(region.scene)});
  }
  db.statements.clear();
}

/// Erases what a request names and records that it was forgotten, inside a transaction.
ForgetResult erase(Store::Connection& db, const ForgetRequest& request, Id run) {
  SQLite::Database& database = *db.database;
  const std::vector<std::string> triggers = db.values<std::string>(
      "SELECT sql FROM sqlite_schema WHERE type = 'trigger' AND name LIKE '%_append_only'");
  db.statements.clear();
  for (const char* table : {"association", "event", "object", "belief", "fact"})
    database.exec(fmt::format("DROP TRIGGER {}_append_only", table));
  constexpr const char* kErased[] = {"gone_object", "gone_observation", "gone_image"};
  for (const char* table : kErased)
    database.exec(fmt::format("CREATE TEMP TABLE {} (id INTEGER PRIMARY KEY)", table));
  if (request.object) {
    run_all(database, kEraseObject, {sql(*request.object)});
    erase_from_depth(db);
  } else {
    run_all(database, kEraseInterval, {sql(*request.from), sql(*request.to)});
  }
  run_all(database, kEraseReferences, {});
  drop_unused_blobs(database);
  derive_tables(database);
  const ForgetResult result{query_integer(database, "SELECT count(*) FROM temp.gone_object"),
                            query_integer(database, "SELECT count(*) FROM temp.gone_observation"),
                            query_integer(database, "SELECT count(*) FROM temp.gone_image")};
  run_all(database,
          "INSERT INTO forgotten (object, known_from, run) SELECT id, ?1, ?2 FROM temp.gone_object;",
          {sql(db.known_time()), sql(run)});
  if (!request.object)
    run_all(database,
            "INSERT INTO forgotten (valid_from, valid_to, known_from, run) VALUES (?1, ?2, ?3, ?4);",
            {sql(*request.from), sql(*request.to), sql(db.known_time()), sql(run)});
  for (const char* table : kErased) database.exec(fmt::format("DROP TABLE temp.{}", table));
  for (const std::string& trigger : triggers) database.exec(trigger);
  return result;
}

/// Overwrites what was deleted, in the file and in its log.
void overwrite_deleted(SQLite::Database& database) {
  database.exec("VACUUM");
  database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
}

/// Images, depth thumbnails with their pixel kinds, and clouds.
void discard_images(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.scenes_without_images = run_all(database,
                                         "UPDATE scene SET image = NULL, depth = NULL, depth_width = NULL, "
                                         "depth_height = NULL, pixel_kinds = NULL "
                                         "WHERE time < ? AND (image IS NOT NULL OR depth IS NOT NULL);",
                                         {sql(before)});
}

/// Without the images, or without the mask, a cloud is of no use.
void discard_clouds(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.observations_without_points += run_all(
      database,
      "UPDATE observation SET cloud = NULL WHERE cloud IS NOT NULL AND scene IN (SELECT id FROM scene WHERE "
      "time < ?);",
      {sql(before)});
}

/// Crops, masks, and feature structures with large arrays.
void discard_crops(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.observations_without_crops = run_all(database,
                                              "UPDATE observation SET crop = NULL, mask = NULL WHERE (crop "
                                              "IS NOT NULL OR mask IS NOT NULL) AND scene IN "
                                              "(SELECT id FROM scene WHERE time < ?);",
                                              {sql(before)});
  database.exec("CREATE TEMP TABLE gone (id INTEGER PRIMARY KEY)");
  result.arrays =
      run_all(database,
              "INSERT INTO temp.gone SELECT DISTINCT l.feature_structure FROM feature_structure_blob l JOIN "
              "feature_structure f ON f.id = l.feature_structure JOIN scene s ON s.id = f.scene WHERE s.time "
              "< ?;",
              {sql(before)});
  database.exec(
      "UPDATE annotation SET feature_structure = NULL WHERE feature_structure IN (SELECT id FROM temp.gone);"
      "DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM temp.gone);"
      "DELETE FROM feature_structure WHERE id IN (SELECT id FROM temp.gone); DROP TABLE temp.gone");
}

/// The row remains, empty: it was discarded.
void discard_reasoning(SQLite::Database& database, TimeNs before, RetentionResult& result) {
  result.scenes_without_reasoning = run_all(database,
                                            "UPDATE reasoning SET encoding = 0, content = x'' WHERE "
                                            "length(content) > 0 AND scene IN (SELECT id FROM "
                                            "scene WHERE time < ?);",
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

}  // namespace

ForgetResult Store::forget(const ForgetRequest& request, Id run) {
  auto& db = *connection_;
  db.require_writable();
  if (!request.object && !(request.from && request.to))
    throw error("nothing to forget is named", "name an object, or two times");
  return db.guarded([&] {
    SQLite::Database& database = *db.database;
    db.statements.clear();
    db.clear_caches();
    database.exec("PRAGMA secure_delete = ON; PRAGMA foreign_keys = OFF");
    try {
      SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
      const ForgetResult result = erase(db, request, run);
      db.statements.clear();
      all.commit();
      overwrite_deleted(database);
      database.exec("PRAGMA foreign_keys = ON");
      return result;
    } catch (...) {
      db.statements.clear();
      database.tryExec("PRAGMA foreign_keys = ON");
      throw;
    }
  });
}

std::vector<ForgottenRow> Store::forgotten() const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::vector<ForgottenRow> rows;
    db.query("SELECT * FROM forgotten ORDER BY id", {}, [&](const SqlRow& row) {
      rows.push_back({row.get<std::optional<Id>>("object"), row.get<std::optional<TimeNs>>("valid_from"),
                      row.get<std::optional<TimeNs>>("valid_to"), row.get<TimeNs>("known_from")});
    });
    return rows;
  });
}

RetentionResult retain(const fs::path& memory, const RetentionRules& rules) {
  if (!rules.images_s && !rules.crops_s && !rules.reasoning_s)
    throw Error("nothing to discard is named", {memory.string(), 0, {}}, "give an age");
  if (rules.images_s && rules.crops_s && *rules.crops_s < *rules.images_s)
    throw Error("crops would go before the images that they are of", {memory.string(), 0, {}},
                "keep crops at least as long as images");
  { const Store exists = Store::open_read(memory); }
  RetentionResult result;
  Store store = Store::open_write(memory);
  const std::optional<TimeNs> last = store.last_scene_time();
  if (!last) throw store.error("the memory has no scene yet");
  result.bytes_before = static_cast<int64_t>(fs::file_size(memory));
  try {
    // Beside the store, whose lock keeps other writers out.
    SQLite::Database database(memory.string(), SQLite::OPEN_READWRITE);
    database.setBusyTimeout(5000);
    database.exec("PRAGMA secure_delete = ON");
    SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
    const auto discard = [&](const std::optional<double>& age_s, auto what) {
      if (age_s) what(database, *last - static_cast<TimeNs>(*age_s * double(kSecond)), result);
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
  } catch (const SQLite::Exception& error) {
    throw_database_error(error, memory);
  }
  result.bytes_after = static_cast<int64_t>(fs::file_size(memory));
  store.finish_run(store.begin_run("loci-memory retain", configuration_text(rules, result)));
  return result;
}

}  // namespace loci::memory
