#include "apps/evaluate/memory/plain.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "mapping/base/stopwatch.h"

namespace loci::apps::memory_experiment {

struct PlainTables::Implementation {
  explicit Implementation(const std::filesystem::path& file)
      : database(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {}

  SQLite::Database database;
  double rate = 0;

  size_t count(SQLite::Statement& query) {
    size_t rows = 0;
    while (query.executeStep()) ++rows;
    return rows;
  }
};

PlainTables::PlainTables(const std::filesystem::path& file, const std::filesystem::path& memory)
    : implementation_(std::make_unique<Implementation>(file)) {
  SQLite::Database& database = implementation_->database;
  database.exec(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;"
      "CREATE TABLE seen (id INTEGER PRIMARY KEY, scene INTEGER, time INTEGER, object INTEGER, place "
      "INTEGER, x REAL, "
      "y REAL, z REAL, class TEXT, text TEXT);"
      "CREATE INDEX seen_object ON seen (object, time); CREATE INDEX seen_place ON seen (place, time);"
      "CREATE INDEX seen_x ON seen (x); CREATE INDEX seen_class ON seen (class);"
      "CREATE TABLE stay (object INTEGER, place INTEGER, x REAL, y REAL, z REAL, since INTEGER, until "
      "INTEGER);"
      "CREATE INDEX stay_x ON stay (x, y); CREATE INDEX stay_place ON stay (place, since);");
  const SQLite::Database source(memory.string(), SQLite::OPEN_READONLY);
  SQLite::Statement rows(
      source,
      "SELECT o.scene, s.time, a.object, o.place, o.x, o.y, o.z, (SELECT value FROM annotation_value n WHERE "
      "n.scene = "
      "o.scene AND n.observation = o.id AND n.type LIKE '%Classification%'), (SELECT value FROM "
      "annotation_value n WHERE "
      "n.scene = o.scene AND n.observation = o.id AND n.type LIKE '%Text%') FROM observation o JOIN scene s "
      "ON s.id = "
      "o.scene LEFT JOIN association a ON a.observation = o.id AND a.chosen = 1 ORDER BY o.id");
  SQLite::Statement add(
      database,
      "INSERT INTO seen (scene, time, object, place, x, y, z, class, text) VALUES (?,?,?,?,?,?,?,?,?)");
  size_t written = 0;
  int64_t scene = 0;
  double seconds = 0;
  std::unique_ptr<SQLite::Transaction> transaction;
  while (rows.executeStep()) {
    Stopwatch watch;
    if (rows.getColumn(0).getInt64() != scene) {
      if (transaction) transaction->commit();
      transaction = std::make_unique<SQLite::Transaction>(database);
      scene = rows.getColumn(0).getInt64();
    }
    for (int i = 0; i < 9; ++i) {
      const SQLite::Column value = rows.getColumn(i);
      if (value.isNull())
        add.bind(i + 1);
      else if (value.isInteger())
        add.bind(i + 1, value.getInt64());
      else if (value.isFloat())
        add.bind(i + 1, value.getDouble());
      else
        add.bind(i + 1, value.getString());
    }
    add.exec();
    add.reset();
    ++written;
    seconds += watch.seconds();
  }
  if (transaction) transaction->commit();
  implementation_->rate = static_cast<double>(written) / std::max(1e-9, seconds);
  database.exec("ATTACH '" + memory.string() + "' AS memory");
  database.exec(
      "INSERT INTO stay SELECT object, place_from, x_from / 1000.0, y_from / 1000.0, z_from / 1000.0, since, "
      "until FROM "
      "memory.stay");
  database.exec("DETACH memory; ANALYZE");
}

PlainTables::~PlainTables() = default;

double PlainTables::write_rate() const {
  return implementation_->rate;
}

size_t PlainTables::near(const Vector3d& point, double radius, TimeNs time) {
  SQLite::Statement query(
      implementation_->database,
      "SELECT object FROM stay WHERE x BETWEEN ?1 - ?4 AND ?1 + ?4 AND y BETWEEN ?2 - ?4 AND ?2 + "
      "?4 AND z BETWEEN ?3 - ?4 AND ?3 + ?4 AND since <= ?5 AND until >= ?5");
  for (int axis = 0; axis < 3; ++axis) query.bind(axis + 1, point[axis]);
  query.bind(4, radius);
  query.bind(5, time / kSecond);
  return implementation_->count(query);
}

size_t PlainTables::at_place(int64_t place, TimeNs time) {
  SQLite::Statement query(implementation_->database,
                          "SELECT object FROM stay WHERE place = ?1 AND since <= ?2 AND until >= ?2");
  query.bind(1, place);
  query.bind(2, time / kSecond);
  return implementation_->count(query);
}

size_t PlainTables::with_text(const std::string& word) {
  SQLite::Statement query(implementation_->database, "SELECT DISTINCT object FROM seen WHERE text LIKE ?");
  query.bind(1, "%" + word + "%");
  return implementation_->count(query);
}

size_t PlainTables::last_seen(int64_t object) {
  SQLite::Statement query(implementation_->database,
                          "SELECT * FROM seen WHERE object = ? ORDER BY time DESC LIMIT 1");
  query.bind(1, object);
  return implementation_->count(query);
}

}  // namespace loci::apps::memory_experiment
