#include "memory/store/merge.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "mapping/base/json.h"
#include "memory/store/copy.h"
#include "memory/store/database.h"
#include "memory/store/schema.h"
#include "memory/store/scratch_memory.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

/// A table whose rows come in: columns that name rows of other tables, and those by which a row is known to
/// be there already (none: in a way of its own).
struct Joined {
  std::string table;
  std::vector<std::pair<std::string, std::string>> references;  ///< column, table
  std::vector<std::string> key;
};

/// In an order in which what is referred to comes first.
const std::vector<Joined>& joined_tables() {
  static const std::vector<Joined> tables = {
      {"run", {}, {"program", "version", "configuration", "started"}},
      {"blob", {}, {"hash"}},
      {"map", {{"urdf", "blob"}, {"sidecar", "blob"}}, {"hash"}},
      {"type_system", {{"content", "blob"}}, {"hash"}},
      {"place", {{"map", "map"}, {"run", "run"}}, {"name"}},
      {"recording", {}, {"fingerprint"}},
      {"scene",
       {{"recording", "recording"},
        {"map", "map"},
        {"depth", "blob"},
        {"image", "blob"},
        {"kinds", "blob"},
        {"run", "run"}},
       {}},
      {"observation",
       {{"scene", "scene"}, {"place", "place"}, {"crop", "blob"}, {"mask", "blob"}, {"cloud", "blob"}},
       {"scene", "number"}},
      {"term", {}, {"value", "type"}},
      {"feature_structure",
       {{"scene", "scene"}, {"observation", "observation"}, {"type_system", "type_system"}},
       {"scene", "observation", "type", "content"}},
      {"annotation",
       {{"scene", "scene"},
        {"observation", "observation"},
        {"term", "term"},
        {"feature_structure", "feature_structure"}},
       {"scene", "observation", "term", "feature_structure"}},
      {"object", {{"supersedes", "object"}, {"run", "run"}}, {}},
      {"association",
       {{"scene", "scene"},
        {"observation", "observation"},
        {"object", "object"},
        {"supersedes", "association"},
        {"run", "run"}},
       {"scene", "observation", "object", "explanation", "probability", "chosen", "known_from", "run"}},
      {"event",
       {{"scene", "scene"},
        {"object", "object"},
        {"observation", "observation"},
        {"place", "place"},
        {"from_place", "place"},
        {"supersedes", "event"},
        {"run", "run"}},
       {"scene", "kind", "object", "joint", "probability", "valid_from", "known_from", "run"}},
      {"belief",
       {{"object", "object"},
        {"scene", "scene"},
        {"place", "place"},
        {"last_scene", "scene"},
        {"last_observation", "observation"},
        {"supersedes", "belief"},
        {"run", "run"}},
       {"object", "scene", "status", "probability", "valid_from", "known_from", "run"}},
      {"visibility",
       {{"scene", "scene"}, {"object", "object"}, {"place", "place"}, {"run", "run"}},
       {"scene", "object", "place", "status"}},
      {"fact",
       {{"object", "object"}, {"place", "place"}, {"supersedes", "fact"}, {"run", "run"}},
       {"object", "place", "key", "value", "valid_from", "known_from", "source"}},
      {"forgotten",
       {{"object", "object"}, {"run", "run"}},
       {"object", "valid_from", "valid_to", "known_from"}},
  };
  return tables;
}

/// Copies a memory and brings the copy to this program's format.
void copy_as_of_now(const fs::path& from, const fs::path& to) {
  { const Store check = Store::open_read(from); }
  copy_memory(from, to);
  { Store::open_write(to); }
}

class Merger {
 public:
  Merger(SQLite::Database& database, const fs::path& first, const fs::path& second,
         const std::optional<FrameChange>& frame)
      : database_(database), first_(first), second_(second), frame_(frame) {}

  MergeResult run(Progress& progress) {
    check_frames();
    if (frame_ && !frame_->is_none()) change_frame();
    rename_places();
    double done = 0;
    for (const Joined& joined : joined_tables()) {
      progress.check(done++ / static_cast<double>(joined_tables().size()),
                     fmt::format("joining {}", joined.table));
      join(joined);
    }
    database_.exec(
        "INSERT OR IGNORE INTO main.feature_structure_blob SELECT f.new, b.new FROM "
        "other.feature_structure_blob o JOIN temp.of_feature_structure f ON f.old = o.feature_structure JOIN "
        "temp.of_blob b ON b.old = o.blob");
    database_.exec(
        "INSERT OR IGNORE INTO main.reasoning (scene, encoding, content) SELECT s.new, o.encoding, o.content "
        "FROM other.reasoning o JOIN temp.of_scene s ON s.old = o.scene");
    database_.exec(
        "INSERT OR IGNORE INTO main.scene_log SELECT s.new, o.number, o.annotator, o.level, o.text, "
        "o.milliseconds FROM other.scene_log o JOIN temp.of_scene s ON s.old = o.scene");
    // The belief of one of them is not that of both: what goes on begins from what is believed now.
    if (result_.scenes > 0) database_.exec("DELETE FROM main.checkpoint");
    database_.exec(kDerivation);
    database_.exec(kCounting);
    return std::move(result_);
  }

 private:
  int64_t number(const std::string& query) { return database_.execAndGet(query).getInt64(); }

  void check_frames() {
    if (frame_) return;
    const int64_t common_maps = number("SELECT count(*) FROM other.map o JOIN main.map m ON m.hash = o.hash");
    const int64_t maps = number("SELECT (SELECT count(*) FROM main.map) + (SELECT count(*) FROM other.map)");
    const int64_t recordings = number(
        "SELECT count(*) FROM other.recording o JOIN main.recording m ON m.fingerprint = o.fingerprint");
    const bool empty =
        number("SELECT min((SELECT count(*) FROM main.scene), (SELECT count(*) FROM other.scene))") == 0;
    if (empty || common_maps > 0 || recordings > 0) return;
    throw Error(
        fmt::format(
            "{} and {} are not known to be in one map frame: {}", first_.filename().string(),
            second_.filename().string(),
            maps > 0 ? "they have no map in common" : "they have neither map nor recording in common"),
        {second_.string(), 0, {}},
        "say where the second frame lies in the first with --transform x,y,z,yaw_deg (0,0,0,0 = the same)");
  }

  /// Everything of the second memory that says where something is, but for the images, goes into the first
  /// one's frame.
  void change_frame() {
    const double c = std::cos(frame_->yaw), s = std::sin(frame_->yaw);
    const double half_c = std::cos(frame_->yaw / 2), half_s = std::sin(frame_->yaw / 2);
    const Vector3d& t = frame_->translation;
    const auto positions = [&](const std::string& table, const std::string& prefix) {
      SQLite::Statement move(
          database_,
          fmt::format("UPDATE other.{0} SET {1}x = ?1 + ?4 * {1}x - ?5 * {1}y, {1}y = ?2 + ?5 * {1}x + "
                      "?4 * {1}y, {1}z = {1}z + ?3 WHERE {1}x IS NOT NULL",
                      table, prefix));
      int index = 0;
      for (const double value : {t.x(), t.y(), t.z(), c, s}) move.bind(++index, value);
      move.exec();
    };
    const auto turns = [&](const std::string& table, const std::string& prefix) {
      // (0, 0, half_s, half_c) times the old quaternion.
      SQLite::Statement turn(
          database_,
          fmt::format(
              "UPDATE other.{0} SET {1}qx = ?1 * {1}qx - ?2 * {1}qy, {1}qy = ?1 * {1}qy + ?2 * {1}qx, "
              "{1}qz = ?1 * {1}qz + ?2 * {1}qw, {1}qw = ?1 * {1}qw - ?2 * {1}qz WHERE {1}qx IS NOT NULL",
              table, prefix));
      turn.bind(1, half_c);
      turn.bind(2, half_s);
      turn.exec();
    };
    for (const char* table : {"event", "belief"})
      database_.exec(fmt::format("DROP TRIGGER other.{}_is_kept", table));
    for (const auto& [table, prefix] : {std::pair{"scene", ""},
                                        {"observation", ""},
                                        {"observation", "box_"},
                                        {"place", ""},
                                        {"event", ""},
                                        {"event", "from_"},
                                        {"belief", ""}})
      positions(table, prefix);
    for (const auto& [table, prefix] : {std::pair{"scene", ""}, {"observation", "box_"}, {"place", ""}})
      turns(table, prefix);
    SQLite::Statement places(database_, "SELECT id, outline FROM other.place WHERE outline IS NOT NULL");
    std::vector<std::pair<int64_t, std::string>> outlines;
    while (places.executeStep()) {
      Json outline = parse_json(places.getColumn(1).getString(), "place.outline");
      for (Json& corner : outline) {
        const double x = corner.at(0).get<double>(), y = corner.at(1).get<double>();
        corner = {t.x() + c * x - s * y, t.y() + s * x + c * y};
      }
      outlines.emplace_back(places.getColumn(0).getInt64(), outline.dump());
    }
    SQLite::Statement change(database_, "UPDATE other.place SET outline = ? WHERE id = ?");
    for (const auto& [id, outline] : outlines) {
      change.bind(1, outline);
      change.bind(2, id);
      change.exec();
      change.reset();
    }
    SQLite::Statement raise(database_, "UPDATE other.place SET height = height + ?");
    raise.bind(1, t.z());
    raise.exec();
    result_.reasoning = number("SELECT count(*) FROM other.reasoning");
    database_.exec("DELETE FROM other.reasoning");
  }

  struct Spot {
    std::optional<double> x, y, height;
    /// Places of one name at one spot are one place, also where one of them is not known so well.
    bool is_at(const Spot& other) const {
      const auto near = [](const std::optional<double>& a, const std::optional<double>& b, double apart) {
        return !a || !b || std::abs(*a - *b) <= apart;
      };
      return near(x, other.x, 0.5) && near(y, other.y, 0.5) && near(height, other.height, 0.1);
    }
  };

  std::map<std::string, Spot> spots(const std::string& schema) {
    std::map<std::string, Spot> spots;
    SQLite::Statement places(database_, fmt::format("SELECT name, outline, height FROM {}.place", schema));
    while (places.executeStep()) {
      Spot& spot = spots[places.getColumn(0).getString()];
      if (!places.getColumn(2).isNull()) spot.height = places.getColumn(2).getDouble();
      if (places.getColumn(1).isNull()) continue;
      const Json outline = parse_json(places.getColumn(1).getString(), "place.outline");
      if (outline.empty()) continue;
      double x = 0, y = 0;
      for (const Json& corner : outline) {
        x += corner.at(0).get<double>();
        y += corner.at(1).get<double>();
      }
      spot.x = x / static_cast<double>(outline.size());
      spot.y = y / static_cast<double>(outline.size());
    }
    return spots;
  }

  /// A place of the second memory that lies elsewhere than the first one's of this name gets a name of its
  /// own.
  void rename_places() {
    const std::map<std::string, Spot> here = spots("main");
    SQLite::Statement rename(database_, "UPDATE other.place SET name = ? WHERE name = ?");
    std::map<std::string, Spot> there = spots("other");
    for (const auto& [name, spot] : there) {
      std::string free = name;
      for (int n = 2;; ++n) {
        const auto known = here.find(free);
        const bool is_it = known == here.end() || known->second.is_at(spot);
        if (is_it && (free == name || !there.contains(free))) break;
        free = fmt::format("{}_{}", name, n);
      }
      if (free == name) continue;
      rename.bind(1, free);
      rename.bind(2, name);
      rename.exec();
      rename.reset();
      result_.renamed.emplace_back(name, free);
    }
  }

  std::vector<std::string> columns_of(const std::string& table) {
    std::vector<std::string> columns;
    SQLite::Statement info(database_, "SELECT name FROM pragma_table_info(?)");
    info.bind(1, table);
    while (info.executeStep())
      if (const std::string name = info.getColumn(0).getString(); name != "id") columns.push_back(name);
    return columns;
  }

  void join(const Joined& joined) {
    const std::string table = joined.table, map = "temp.of_" + table, rows = "temp.rows_of_" + table;
    const std::vector<std::string> columns = columns_of(table);
    database_.exec(
        fmt::format("CREATE TEMP TABLE of_{} (old INTEGER PRIMARY KEY, new INTEGER NOT NULL)", table));
    // The second memory's rows with the first one's numbers, as far as those are known.
    std::vector<std::string> values;
    for (const std::string& column : columns) {
      std::string value = "o." + column;
      for (const auto& [name, other] : joined.references)
        if (column == name && other != table)
          value = fmt::format("(SELECT new FROM temp.of_{} WHERE old = o.{})", other, column);
      values.push_back(value + " AS " + column);
    }
    database_.exec(fmt::format("CREATE TEMP TABLE rows_of_{0} AS SELECT o.id AS id, {1} FROM other.{0} o",
                               table, fmt::join(values, ", ")));
    if (table == "scene")
      know_scenes();
    else if (table == "object")
      know_objects();
    else
      know_by_key(joined);
    const int64_t known = number("SELECT count(*) FROM " + map);
    database_.exec(
        fmt::format("INSERT INTO {0} SELECT id, (SELECT coalesce(max(id), 0) FROM main.{1}) + row_number() "
                    "OVER (ORDER BY id) "
                    "FROM {2} WHERE id NOT IN (SELECT old FROM {0})",
                    map, table, rows));
    // What names a row of its own table can only be translated now.
    for (const auto& [name, other] : joined.references)
      if (other == table)
        database_.exec(
            fmt::format("UPDATE {0} SET {1} = (SELECT new FROM {2} WHERE old = {1}) WHERE {1} IS NOT NULL",
                        rows, name, map));
    const int64_t before = number("SELECT count(*) FROM main." + table);
    database_.exec(
        fmt::format("INSERT INTO main.{0} (id, {1}) SELECT m.new, {1} FROM {2} r JOIN {3} m ON m.old = r.id "
                    "WHERE m.new > "
                    "(SELECT coalesce(max(id), 0) FROM main.{0}) ORDER BY m.new",
                    table, fmt::join(columns, ", "), rows, map));
    const int64_t added = number("SELECT count(*) FROM main." + table) - before;
    database_.exec(fmt::format("DROP TABLE {}", rows));
    if (table == "scene") result_.scenes = added, result_.known_scenes = known;
    if (table == "observation") result_.observations = added;
    if (table == "object") result_.objects = added;
    if (table == "fact") result_.facts = added;
  }

  void know_by_key(const Joined& joined) {
    std::string same;
    for (const std::string& column : joined.key)
      same += fmt::format("{0}m.{1} IS r.{1}", same.empty() ? "" : " AND ", column);
    database_.exec(fmt::format(
        "INSERT INTO temp.of_{0} SELECT r.id, min(m.id) FROM temp.rows_of_{0} r JOIN main.{0} m ON {1} "
        "GROUP BY r.id",
        joined.table, same));
  }

  /// By recording and frame; where there is no recording, by the times.
  void know_scenes() {
    database_.exec(
        "INSERT INTO temp.of_scene SELECT r.id, min(m.id) FROM temp.rows_of_scene r JOIN main.scene m ON "
        "m.recording = r.recording AND m.frame_index = r.frame_index GROUP BY r.id");
    database_.exec(
        "INSERT INTO temp.of_scene SELECT r.id, min(m.id) FROM temp.rows_of_scene r JOIN main.scene m ON "
        "m.time = "
        "r.time AND m.known_from = r.known_from WHERE r.recording IS NULL AND m.recording IS NULL GROUP BY "
        "r.id");
  }

  /// An object is known by what was seen of it; one of which nothing is left (forgotten), by its times.
  void know_objects() {
    database_.exec(
        "INSERT INTO temp.of_object SELECT b.object, min(a.object) FROM other.association b JOIN "
        "temp.of_observation o ON o.old = b.observation JOIN main.association a ON a.observation = o.new "
        "WHERE "
        "b.chosen = 1 AND a.chosen = 1 AND b.object IS NOT NULL AND a.object IS NOT NULL GROUP BY b.object");
    database_.exec(
        "INSERT INTO temp.of_object SELECT r.id, min(m.id) FROM temp.rows_of_object r JOIN main.object m ON "
        "m.valid_from = r.valid_from AND m.known_from = r.known_from AND m.source = r.source WHERE r.id NOT "
        "IN "
        "(SELECT object FROM other.association WHERE object IS NOT NULL AND chosen = 1 AND observation IS "
        "NOT "
        "NULL) AND m.id NOT IN (SELECT object FROM main.association WHERE object IS NOT NULL AND chosen = 1 "
        "AND "
        "observation IS NOT NULL) GROUP BY r.id");
  }

  SQLite::Database& database_;
  fs::path first_, second_;
  std::optional<FrameChange> frame_;
  MergeResult result_;
};

}  // namespace

MergeResult merge(const fs::path& first, const fs::path& second, const fs::path& output,
                  const std::optional<FrameChange>& frame, Progress& progress) {
  if (fs::exists(output))
    throw Error("there is a file already", {output.string(), 0, {}}, "name a new memory with -o");
  const ScratchMemory other(output.string() + ".second");
  MergeResult result;
  make_as_a_whole(output, [&](const fs::path& joined) {
    copy_as_of_now(first, joined);
    copy_as_of_now(second, other.path());
    try {
      SQLite::Database database(joined.string(), SQLite::OPEN_READWRITE);
      SQLite::Statement attach(database, "ATTACH ? AS other");
      attach.bind(1, other.path().string());
      attach.exec();
      SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
      result = Merger(database, first, second, frame).run(progress);
      all.commit();
      database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const SQLite::Exception& error) {
      throw_database_error(error, joined);
    }
    { Store::open_write(joined); }
  });
  return result;
}

}  // namespace loci::memory
