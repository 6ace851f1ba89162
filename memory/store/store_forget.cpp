// What is forgotten is gone from the file: rows, images, words, and the places where they lay in the file.
// That something was forgotten stays known.

#include "memory/store/depth_thumbnail.h"
#include "memory/store/reading.h"
#include "memory/store/scene_kinds.h"
#include "memory/store/schema.h"

namespace loci::memory {
namespace {

/// What goes, in temporary tables: observations, objects of which nothing is left, scenes whose images go.
constexpr const char* kOfObject = R"sql(
INSERT INTO temp.gone_object VALUES (?1);
INSERT INTO temp.gone_observation SELECT DISTINCT observation FROM association
  WHERE object = ?1 AND chosen = 1 AND observation IS NOT NULL;
INSERT INTO temp.gone_image SELECT DISTINCT o.scene FROM temp.gone_observation g JOIN observation o ON o.id = g.id;
)sql";

constexpr const char* kOfInterval = R"sql(
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
UPDATE scene SET depth = NULL, depth_width = NULL, depth_height = NULL, kinds = NULL, joints = NULL, x = NULL, y = NULL, z = NULL,
  qx = NULL, qy = NULL, qz = NULL, qw = NULL WHERE id IN (SELECT id FROM temp.gone_image);
)sql";

constexpr const char* kOfBoth = R"sql(
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
DELETE FROM annotation WHERE term IN (SELECT id FROM term WHERE type = 'loci.memory.CarriedBelief');
DELETE FROM reasoning WHERE scene IN (SELECT id FROM temp.gone_image);
DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM feature_structure
  WHERE observation IN (SELECT id FROM temp.gone_observation));
DELETE FROM feature_structure WHERE observation IN (SELECT id FROM temp.gone_observation);
DELETE FROM observation WHERE id IN (SELECT id FROM temp.gone_observation);
UPDATE scene_log SET text = NULL WHERE scene IN (SELECT id FROM temp.gone_image);
UPDATE scene SET image = NULL WHERE id IN (SELECT id FROM temp.gone_image);
DELETE FROM term WHERE id NOT IN (SELECT term FROM annotation);
)sql";

/// Statements one after the other, each with as many of the values as it names.
void run_all(SQLite::Database& database, const char* text, const std::vector<SqlValue>& values) {
  const std::string all = text;
  for (size_t begin = 0, end = 0; (end = all.find(';', begin)) != std::string::npos; begin = end + 1) {
    SQLite::Statement statement(database, all.substr(begin, end - begin + 1));
    const auto wanted = static_cast<size_t>(statement.getBindParameterCount());
    bind_values(statement, {values.begin(),
                            values.begin() + static_cast<std::ptrdiff_t>(std::min(wanted, values.size()))});
    statement.exec();
  }
}

/// Where what was seen of an object lies in a scene's thumbnail.
struct Cut {
  Id scene = 0;
  int64_t width = 0, height = 0;
  std::optional<std::array<double, 4>> sides;  ///< left, top, right, bottom in pixels of the thumbnail

  bool holds(int64_t x, int64_t y) const {
    const auto& [left, top, right, bottom] = *sides;
    const auto u = static_cast<double>(x), v = static_cast<double>(y);
    return u >= left && u <= right && v >= top && v <= bottom;
  }
};

/// Its region of interest with a pixel around it.
std::vector<Cut> cuts_of(Store::Implementation& store) {
  std::vector<Cut> cuts;
  store.query(
      "SELECT o.scene, s.depth_width, s.depth_height, s.camera_width, s.camera_height, o.roi_x, o.roi_y, "
      "o.roi_width, o.roi_height FROM temp.gone_observation g JOIN observation o ON o.id = g.id JOIN scene s "
      "ON s.id = o.scene WHERE s.depth IS NOT NULL ORDER BY o.id",
      {}, [&](const SqlRow& row) {
        Cut cut{row.integer("scene"), row.integer("depth_width"), row.integer("depth_height"), std::nullopt};
        if (!row.is_null("roi_x") && !row.is_null("camera_width")) {
          const double across = double(cut.width) / row.real("camera_width"),
                       down = double(cut.height) / row.real("camera_height");
          const double x = row.real("roi_x"), y = row.real("roi_y");
          cut.sides = {x * across - 1, y * down - 1, (x + row.real("roi_width")) * across + 1,
                       (y + row.real("roi_height")) * down + 1};
        }
        cuts.push_back(cut);
      });
  return cuts;
}

/// Sets to 0 what a cut holds of an image of a scene (a column of that table) with so many bytes per pixel.
void cut_out(Store::Implementation& store, const Cut& cut, const std::string& column, const char* media,
             int64_t pixel_bytes) {
  std::optional<Id> left;
  if (cut.sides) {
    std::string bytes;
    store.query(fmt::format("SELECT b.encoding, b.content, b.size FROM scene s JOIN blob b ON b.id = s.{} "
                            "WHERE s.id = ?",
                            column),
                {sql(cut.scene)}, [&](const SqlRow& row) {
                  bytes = decode_bytes(row.bytes("content"), row.integer("encoding"), row.integer("size"),
                                       store.path);
                });
    if (bytes.empty()) return;
    for (int64_t y = 0; y < cut.height; ++y)
      for (int64_t x = 0; x < cut.width; ++x) {
        const auto at = static_cast<size_t>(pixel_bytes * (y * cut.width + x));
        const auto size = static_cast<size_t>(pixel_bytes);
        if (cut.holds(x, y) && at + size <= bytes.size()) bytes.replace(at, size, size, '\0');
      }
    left = store.add_blob(bytes, media);
  }
  store.run(fmt::format("UPDATE scene SET {} = ?1 WHERE id = ?2", column).c_str(),
            {sql(left), sql(cut.scene)});
}

/// What was seen of an object leaves the depth thumbnails, and what their pixels are. Where no region is
/// known, all of the thumbnail.
void cut_out_of_depth(Store::Implementation& store) {
  for (const Cut& cut : cuts_of(store)) {
    cut_out(store, cut, "depth", kDepthThumbnailMedia, 2);
    cut_out(store, cut, "kinds", kSceneKindsMedia, 1);
    if (!cut.sides)
      store.run("UPDATE scene SET depth_width = NULL, depth_height = NULL WHERE id = ?", {sql(cut.scene)});
  }
  store.statements.clear();
}

int64_t count(SQLite::Database& database, const char* table) {
  return database.execAndGet(std::string("SELECT count(*) FROM ") + table).getInt64();
}

}  // namespace

ForgetResult Store::forget(const ForgetRequest& request, Id run) {
  auto& s = *implementation_;
  s.need_writable();
  if (!request.object && !(request.from && request.to))
    throw Error("nothing to forget is named", {path().string(), 0, {}}, "name an object, or two times");
  ForgetResult result;
  s.guarded([&] {
    SQLite::Database& database = *s.database;
    s.statements.clear();
    s.forget_cached();
    database.exec("PRAGMA secure_delete = ON; PRAGMA foreign_keys = OFF");
    try {
      SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
      // Rows with two clocks are only added, but for this.
      std::vector<std::string> triggers;
      s.query("SELECT sql FROM sqlite_master WHERE type = 'trigger' AND name LIKE '%_is_kept'", {},
              [&](const SqlRow& row) { triggers.push_back(row.text("sql")); });
      s.statements.clear();
      for (const char* table : {"association", "event", "object", "belief", "fact"})
        database.exec(fmt::format("DROP TRIGGER {}_is_kept", table));
      for (const char* table : {"gone_object", "gone_observation", "gone_image"})
        database.exec(fmt::format("CREATE TEMP TABLE {} (id INTEGER PRIMARY KEY)", table));
      if (request.object) {
        run_all(database, kOfObject, {sql(*request.object)});
        cut_out_of_depth(s);
      } else {
        run_all(database, kOfInterval, {sql(*request.from), sql(*request.to)});
      }
      run_all(database, kOfBoth, {});
      database.exec(kDropUnusedBlobs);
      database.exec(kDerivation);
      database.exec(kCounting);
      result.objects = count(database, "temp.gone_object");
      result.observations = count(database, "temp.gone_observation");
      result.scenes = count(database, "temp.gone_image");
      run_all(database,
              "INSERT INTO forgotten (object, known_from, run) SELECT id, ?1, ?2 FROM temp.gone_object;",
              {sql(s.known_time()), sql(run)});
      if (!request.object)
        run_all(database,
                "INSERT INTO forgotten (valid_from, valid_to, known_from, run) VALUES (?1, ?2, ?3, ?4);",
                {sql(*request.from), sql(*request.to), sql(s.known_time()), sql(run)});
      for (const char* table : {"gone_object", "gone_observation", "gone_image"})
        database.exec(fmt::format("DROP TABLE temp.{}", table));
      for (const std::string& trigger : triggers) database.exec(trigger);
      all.commit();
      // What lay in the file is overwritten, and the log emptied.
      database.exec("VACUUM");
      database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (...) {
      database.tryExec("PRAGMA foreign_keys = ON");
      throw;
    }
    database.exec("PRAGMA foreign_keys = ON");
  });
  return result;
}

std::vector<ForgottenRow> Store::forgotten() const {
  if (implementation_->version < 1001) return {};
  return all<ForgottenRow>(
      *implementation_, "SELECT * FROM forgotten ORDER BY id", {}, [](const SqlRow& row) {
        return ForgottenRow{row.optional_integer("object"), row.optional_integer("valid_from"),
                            row.optional_integer("valid_to"), row.integer("known_from")};
      });
}

}  // namespace loci::memory
