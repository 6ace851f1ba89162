#include "memory/store/rows/merge.h"

#include <cmath>
#include <set>

#include "mapping/base/text/json.h"
#include "memory/store/memory_file.h"
#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/row_columns.h"
#include "memory/store/rows/schema_check.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

/// A table whose rows are taken over, and the columns by which a row is recognised. (Runs, scenes and objects
/// have rules of their own.) Of rows about scenes that both memories have, those of the first hold.
struct MergedTable {
  const char* name;
  std::vector<std::string> key;
  const char* taken_over = "1";  ///< which rows o of the second memory are considered
};

constexpr const char* kOfNewScene = "o.scene IS NULL OR o.scene NOT IN (SELECT id FROM temp.common_scene)";
/// What an object is believed to be that only the second memory knows comes along as a whole.
constexpr const char* kOfNewSceneOrObject =
    "o.scene IS NULL OR o.scene NOT IN (SELECT id FROM temp.common_scene) OR o.object IN (SELECT old FROM "
    "temp.of_object WHERE new NOT IN (SELECT id FROM temp.first_object))";
constexpr const char* kOfEditThatComes = "o.run NOT IN (SELECT id FROM temp.left_edit)";

/// In an order in which referred tables come first.
const std::vector<MergedTable>& merged_tables() {
  static const std::vector<MergedTable> tables = {
      {"run", {}},
      {"blob", {"hash"}},
      {"map", {"hash"}},
      {"type_system", {"hash"}},
      {"place", {"name"}},
      {"recording", {"fingerprint"}},
      {"scene", {}},
      {"observation", {"scene", "number"}, kOfNewScene},
      {"term", {"value", "type"}},
      {"feature_structure", {"scene", "observation", "type", "content"}, kOfNewScene},
      {"annotation", {"scene", "observation", "term", "feature_structure"}, kOfNewScene},
      {"object", {}, "o.id IN (SELECT id FROM temp.needed_object)"},
      {"association",
       {"scene", "observation", "object", "explanation", "probability", "chosen", "known_from", "run"},
       kOfNewScene},
      {"event",
       {"scene", "kind", "object", "joint", "probability", "valid_from", "known_from", "run"},
       kOfNewSceneOrObject},
      {"belief",
       {"object", "scene", "status", "probability", "valid_from", "known_from", "run"},
       kOfNewSceneOrObject},
      {"visibility", {"scene", "object", "place", "status"}, kOfNewScene},
      {"fact", {"object", "place", "key", "value", "valid_from", "known_from", "source"}, kOfEditThatComes},
  };
  return tables;
}

/// Copies a memory and migrates the copy to this program's format.
void copy_migrated(const fs::path& from, const fs::path& to) {
  { const Store check = Store::open_read(from); }
  copy_memory(from, to);
  { Store::open_write(to, {.keep_before_migration = false}); }
}

/// What one of them has forgotten, the other forgets too. Returns how many observations went.
int64_t forget_in_both(const fs::path& one, const fs::path& other) {
  Store a = Store::open_write(one), b = Store::open_write(other);
  return a.honour_tombstones(b).observations + b.honour_tombstones(a).observations;
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
    first_new_run_ = number("SELECT coalesce(max(id), 0) + 1 FROM main.run");
    double done = 0;
    for (const MergedTable& merged : merged_tables()) {
      progress.check(done++ / static_cast<double>(merged_tables().size()),
                     fmt::format("merging {}", merged.name));
      merge_table(merged);
    }
    database_.exec(
        "INSERT OR IGNORE INTO main.feature_structure_blob SELECT f.new, b.new FROM "
        "other.feature_structure_blob o JOIN temp.of_feature_structure f ON f.old = o.feature_structure JOIN "
        "temp.of_blob b ON b.old = o.blob");
    const std::string of_new =
        fmt::format(" o JOIN temp.of_scene s ON s.old = o.scene WHERE {}", kOfNewScene);
    database_.exec(
        "INSERT INTO main.reasoning (scene, encoding, content) SELECT s.new, o.encoding, o.content FROM "
        "other.reasoning" +
        of_new);
    database_.exec(
        "INSERT INTO main.scene_log SELECT s.new, o.number, o.annotator, o.level, o.text, o.milliseconds "
        "FROM "
        "other.scene_log" +
        of_new);
    database_.exec(
        "INSERT OR IGNORE INTO main.forgotten SELECT o.id, o.salt, o.valid_from, o.valid_to, o.known_from, "
        "r.new "
        "FROM other.forgotten o JOIN temp.of_run r ON r.old = o.run;"
        "INSERT OR IGNORE INTO main.forgotten_signature SELECT * FROM other.forgotten_signature");
    begin_objects_with_first_rows();
    translate_edits();
    // A checkpoint of one of them does not hold for both.
    if (result_.scenes > 0) database_.exec("DELETE FROM main.checkpoint");
    database_.exec("DELETE FROM main.term WHERE id NOT IN (SELECT term FROM main.annotation)");
    drop_unused_blobs(database_);
    derive_tables(database_);
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
    throw FramesDiffer(
        fmt::format(
            "{} and {} are not known to be in one map frame: {}", first_.filename().string(),
            second_.filename().string(),
            maps > 0 ? "they have no map in common" : "they have neither map nor recording in common"),
        {second_.string(), 0, {}},
        "give the pose of the second frame in the first with --transform x,y,z,yaw_deg (0,0,0,0 = the same)");
  }

  /// Transforms all positions of the second memory into the map frame of the first.
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
      database_.exec(fmt::format("DROP TRIGGER other.{}_append_only", table));
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
      Json outline = Json::array();
      for (const Vector2d& corner : outline_from_json(places.getColumn(1).getString()))
        outline.push_back({t.x() + c * corner.x() - s * corner.y(), t.y() + s * corner.x() + c * corner.y()});
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
    /// What is unknown of one of them agrees.
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
      const std::vector<Vector2d> outline = outline_from_json(places.getColumn(1).getString());
      if (outline.empty()) continue;
      Vector2d sum = Vector2d::Zero();
      for (const Vector2d& corner : outline) sum += corner;
      spot.x = sum.x() / static_cast<double>(outline.size());
      spot.y = sum.y() / static_cast<double>(outline.size());
    }
    return spots;
  }

  /// A place of the second memory that lies elsewhere than the place of this name in the first gets a new
  /// name.
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

  /// The columns of a table but its id, each with the table that it refers to ("" = none).
  std::vector<std::pair<std::string, std::string>> columns_of(const std::string& table) {
    std::vector<std::pair<std::string, std::string>> columns;
    SQLite::Statement info(
        database_,
        "SELECT c.name, coalesce(f.\"table\", '') FROM pragma_table_info(?1) c LEFT JOIN "
        "pragma_foreign_key_list(?1) f ON f.\"from\" = c.name WHERE c.name <> 'id' ORDER BY c.cid");
    info.bind(1, table);
    while (info.executeStep())
      columns.emplace_back(info.getColumn(0).getString(), info.getColumn(1).getString());
    return columns;
  }

  /// Takes over the rows of a table that the first memory does not have. Table temp.of_TABLE maps ids of the
  /// second memory to those of the result.
  void merge_table(const MergedTable& merged) {
    const std::string table = merged.name, ids = "temp.of_" + table, rows = "temp.rows_of_" + table;
    database_.exec(
        fmt::format("CREATE TEMP TABLE of_{} (old INTEGER PRIMARY KEY, new INTEGER NOT NULL)", table));
    // The rows of the second memory with the ids of the result, as far as those are known.
    std::string names, values;
    const auto columns = columns_of(table);
    for (const auto& [column, target] : columns) {
      const bool known = !target.empty() && target != table;
      const std::string name = sql_name(column);
      names += (names.empty() ? "" : ", ") + name;
      values += known ? fmt::format(", (SELECT new FROM temp.{0} WHERE old = o.{1}) AS {1}",
                                    sql_name("of_" + target), name)
                      : ", o." + name;
    }
    if (table == "object") recognise_objects();  // which says which of them come
    // What is said of an object that is a part of one in the first memory is said of that.
    if (table == "fact") database_.exec("INSERT INTO temp.of_object SELECT old, new FROM temp.meant_object");
    database_.exec(
        fmt::format("CREATE TEMP TABLE rows_of_{0} AS SELECT o.id AS id{1} FROM other.{0} o WHERE {2}", table,
                    values, merged.taken_over));
    if (table == "run")
      recognise_runs();
    else if (table == "scene")
      recognise_scenes();
    else if (table == "observation")
      recognise_observations();
    else if (table != "object")
      recognise_by_key(merged);
    for (const auto& [reference, target] : columns)
      if ((table == "event" || table == "belief") && target == "observation")
        check_observations(rows, reference);
    const int64_t known = number("SELECT count(*) FROM " + ids);
    database_.exec(fmt::format(
        "INSERT INTO {0} SELECT id, ({1}) - 1 + row_number() OVER (ORDER BY id) FROM {2} WHERE id "
        "NOT IN (SELECT old FROM {0})",
        ids,
        table == "object" ? kNextObject : fmt::format("SELECT coalesce(max(id), 0) + 1 FROM main.{}", table),
        rows));
    // References to rows of the same table can only be translated now.
    for (const auto& [column, target] : columns)
      if (target == table)
        database_.exec(
            fmt::format("UPDATE {0} SET {1} = (SELECT new FROM {2} WHERE old = {1}) WHERE {1} IS NOT NULL",
                        rows, sql_name(column), ids));
    const int64_t before = number("SELECT count(*) FROM main." + table);
    database_.exec(
        fmt::format("INSERT INTO main.{0} (id, {1}) SELECT m.new, {1} FROM {2} r JOIN {3} m ON m.old = r.id "
                    "WHERE m.new > "
                    "(SELECT coalesce(max(id), 0) FROM main.{0}) ORDER BY m.new",
                    table, names, rows, ids));
    const int64_t added = number("SELECT count(*) FROM main." + table) - before;
    database_.exec(fmt::format("DROP TABLE {}", rows));
    if (table == "scene") result_.scenes = added, result_.known_scenes = known;
    if (table == "observation") leave_edits();
    if (table == "observation") result_.observations = added;
    if (table == "object") result_.objects = added;
    if (table == "fact") result_.facts = added;
  }

  void recognise_by_key(const MergedTable& merged) {
    std::string same;
    for (const std::string& column : merged.key)
      same += fmt::format("{0}m.{1} IS r.{1}", same.empty() ? "" : " AND ", column);
    database_.exec(fmt::format(
        "INSERT INTO temp.of_{0} SELECT r.id, min(m.id) FROM temp.rows_of_{0} r JOIN main.{0} m ON {1} "
        "GROUP BY r.id",
        merged.name, same));
  }

  /// By what was run when. The configuration of an edit has ids, which differ between memories.
  void recognise_runs() {
    database_.exec(fmt::format(
        "INSERT INTO temp.of_run SELECT r.id, min(m.id) FROM temp.rows_of_run r JOIN main.run m "
        "ON m.program = r.program AND m.version = r.version AND m.started = r.started AND "
        "(m.configuration = r.configuration OR r.program LIKE '{}%' OR r.program = '{}') GROUP BY "
        "r.id",
        kEditProgram, kReasonProgram));
  }

  /// By recording and frame; without a recording, by the times.
  void recognise_scenes() {
    database_.exec(
        "INSERT INTO temp.of_scene SELECT r.id, min(m.id) FROM temp.rows_of_scene r JOIN main.scene m ON "
        "m.recording = r.recording AND m.frame_index = r.frame_index GROUP BY r.id");
    database_.exec(
        "INSERT INTO temp.of_scene SELECT r.id, min(m.id) FROM temp.rows_of_scene r JOIN main.scene m ON "
        "m.time = "
        "r.time AND m.known_from = r.known_from WHERE r.recording IS NULL AND m.recording IS NULL GROUP BY "
        "r.id");
    database_.exec(
        "CREATE TEMP TABLE common_scene (id INTEGER PRIMARY KEY);"
        "INSERT INTO temp.common_scene SELECT old FROM temp.of_scene");
  }

  /// In common scenes, the observations at the same spot: a program may have found others, or in another
  /// order.
  void recognise_observations() {
    constexpr double kSame_m = 0.02;
    database_.exec(fmt::format(
        "INSERT INTO temp.of_observation SELECT old, new FROM (SELECT o.id AS old, m.id AS new, min(coalesce("
        "max(abs(m.x - o.x), abs(m.y - o.y), abs(m.z - o.z)), 0)) AS apart FROM other.observation o JOIN "
        "temp.of_scene s ON s.old = o.scene JOIN temp.common_scene c ON c.id = o.scene JOIN main.observation "
        "m ON m.scene = s.new WHERE (abs(m.x - o.x) < {0} AND abs(m.y - o.y) < {0} AND abs(m.z - o.z) < {0}) "
        "OR (m.x IS NULL AND o.x IS NULL AND m.number = o.number) GROUP BY o.id)",
        kSame_m));
  }

  /// Adds to a table that maps objects of the second memory to those of the first the pairs that a query
  /// finds, the most frequent first; `one_to_one`: no two to the same.
  void map_objects(const std::string& table, const std::string& query, bool one_to_one) {
    std::set<int64_t> mapped, taken;
    SQLite::Statement before(database_, "SELECT old, new FROM temp.of_object");
    while (before.executeStep()) {
      mapped.insert(before.getColumn(0).getInt64());
      taken.insert(before.getColumn(1).getInt64());
    }
    SQLite::Statement add(database_, fmt::format("INSERT INTO temp.{} VALUES (?, ?)", table));
    SQLite::Statement pairs(database_, query + " GROUP BY 1, 2 ORDER BY count(*) DESC, 1, 2");
    while (pairs.executeStep()) {
      const int64_t old = pairs.getColumn(0).getInt64(), object = pairs.getColumn(1).getInt64();
      if (mapped.contains(old) || (one_to_one && taken.contains(object))) continue;
      mapped.insert(old);
      taken.insert(object);
      add.bind(1, old);
      add.bind(2, object);
      add.exec();
      add.reset();
    }
  }

  /// By the associations that both have; else by common observations that are associated now; without any, by
  /// its times.
  void recognise_objects() {
    const std::string common =
        "SELECT b.object, a.object FROM other.{0} b JOIN temp.of_observation o ON o.old = b.observation JOIN "
        "main.{0} a ON a.observation = o.new WHERE b.chosen = 1 AND a.chosen = 1 AND b.object IS NOT NULL "
        "AND a.object IS NOT NULL AND ";
    const std::string now = fmt::format(fmt::runtime(common), "association_known") +
                            "b.known_to IS NULL AND a.known_to IS NULL AND b.probability > 0 AND "
                            "a.probability > 0";
    const std::string unseen =
        "NOT IN (SELECT object FROM {}.association WHERE object IS NOT NULL AND chosen = 1 AND observation "
        "IS NOT NULL)";
    map_objects("of_object",
                fmt::format(fmt::runtime(common), "association") +
                    "a.known_from = b.known_from AND a.explanation = b.explanation",
                true);
    map_objects("of_object", now, true);
    map_objects("of_object",
                "SELECT r.id, m.id FROM other.object r JOIN main.object m ON m.valid_from = r.valid_from AND "
                "m.known_from = r.known_from AND m.source = r.source WHERE r.id " +
                    fmt::format(fmt::runtime(unseen), "other") + " AND m.id " +
                    fmt::format(fmt::runtime(unseen), "main"),
                true);
    database_.exec("CREATE TEMP TABLE meant_object (old INTEGER PRIMARY KEY, new INTEGER NOT NULL)");
    map_objects("meant_object", now, false);
    std::string referred;
    for (const char* table : {"association", "event", "belief", "visibility"})
      referred += fmt::format("SELECT o.object FROM other.{} o WHERE {} UNION ", table, kOfNewScene);
    database_.exec(
        "CREATE TEMP TABLE first_object AS SELECT id FROM main.object;"
        "CREATE TEMP TABLE needed_object AS SELECT old AS id FROM temp.of_object UNION " +
        referred +
        fmt::format("SELECT o.object FROM other.fact o WHERE {} AND o.object NOT IN (SELECT old FROM "
                    "temp.meant_object);"
                    "DELETE FROM temp.meant_object WHERE old IN (SELECT id FROM temp.needed_object)",
                    kOfEditThatComes));
  }

  /// In the first memory an observation of a common scene may be of another object.
  void check_observations(const std::string& rows, const std::string& column) {
    database_.exec(fmt::format(
        "UPDATE {0} SET {1} = NULL WHERE {1} IN (SELECT o.id FROM main.observation o JOIN temp.of_scene s ON "
        "s.new = o.scene JOIN temp.common_scene c ON c.id = s.old) AND NOT EXISTS (SELECT 1 FROM "
        "main.association_known a WHERE a.known_to IS NULL AND a.observation = {0}.{1} AND a.object = "
        "{0}.object AND a.chosen = 1 AND a.probability > 0)",
        rows, column));
  }

  /// An object of the first memory may have been seen earlier in the second.
  void begin_objects_with_first_rows() {
    const std::string trigger =
        database_.execAndGet("SELECT sql FROM main.sqlite_schema WHERE name = 'object_append_only'")
            .getString();
    database_.exec("DROP TRIGGER main.object_append_only");
    for (const char* table : {"association", "event"})
      database_.exec(fmt::format(
          "UPDATE main.object SET valid_from = t.first FROM (SELECT object, min(valid_from) AS first FROM "
          "main.{} WHERE object IS NOT NULL GROUP BY object) t WHERE t.object = object.id AND t.first < "
          "object.valid_from",
          table));
    database_.exec(trigger);
  }

  // ---- Edits.

  int64_t translated(const char* table, const Json& id) {
    SQLite::Statement query(database_, fmt::format("SELECT new FROM temp.of_{} WHERE old = ?", table));
    query.bind(1, id.get<int64_t>());
    return query.executeStep() ? query.getColumn(0).getInt64() : 0;
  }

  bool is_in_common_scene(const Json& observation) {
    SQLite::Statement query(database_,
                            "SELECT 1 FROM other.observation o JOIN temp.common_scene c ON c.id = o.scene "
                            "WHERE o.id = ?");
    query.bind(1, observation.get<int64_t>());
    return query.executeStep();
  }

  /// Edits that say what observations of common scenes are stay behind, with the facts that went with them,
  /// also in the next merge.
  void leave_edits() {
    database_.exec(fmt::format(
        "CREATE TEMP TABLE left_edit (id INTEGER PRIMARY KEY);"
        "INSERT INTO temp.left_edit SELECT m.old FROM temp.of_run m JOIN main.run r ON r.id = m.new WHERE "
        "r.configuration = '{}'",
        left_behind().dump()));
    std::map<int64_t, std::string> in_force;
    SQLite::Statement leave(database_, "INSERT INTO temp.left_edit VALUES (?)");
    for_each_new_run([&](int64_t old, int64_t, const std::string& program, Json& configuration) {
      if (program == kReasonProgram) return;
      bool concerns =
          configuration.contains("label") && is_in_common_scene(configuration["label"].at("observation"));
      if (configuration.contains("identity"))
        for (const Json& one : configuration["identity"])
          for (const Json& observation : one.at("observations"))
            concerns = concerns || is_in_common_scene(observation);
      if (!concerns) return;
      leave.bind(1, old);
      leave.exec();
      leave.reset();
      if (configuration.contains("undoes"))
        in_force.erase(configuration["undoes"].get<int64_t>());
      else
        in_force[old] = configuration.value("text", program);
    });
    for (const auto& [run, text] : in_force) result_.left_edits.push_back(text);
  }

  static Json left_behind() { return {{kLeftBehind, true}}; }

  /// Calls `visit` with both ids, program and configuration of runs whose configurations have ids.
  template <class Visit>
  void for_each_new_run(Visit visit) {
    std::vector<std::pair<int64_t, RunRow>> runs;
    SQLite::Statement query(
        database_, fmt::format("SELECT m.old, m.new, o.program, o.configuration FROM temp.of_run m JOIN "
                               "other.run o ON o.id = m.old WHERE m.new >= {} AND (o.program LIKE '{}%' OR "
                               "o.program = '{}') ORDER BY m.new",
                               first_new_run_, kEditProgram, kReasonProgram));
    while (query.executeStep()) {
      RunRow run;
      run.id = query.getColumn(1).getInt64();
      run.program = query.getColumn(2).getString();
      run.configuration = query.getColumn(3).getString();
      runs.emplace_back(query.getColumn(0).getInt64(), run);
    }
    for (auto& [old, run] : runs) {
      RunRow named = run;
      named.id = old;  // as an error names it
      Json configuration = configuration_of(named, second_);
      visit(old, run.id, run.program, configuration);
    }
  }

  /// Edits of the second memory that come have the ids of the result.
  void translate_edits() {
    SQLite::Statement change(database_, "UPDATE main.run SET configuration = ? WHERE id = ?");
    for_each_new_run([&](int64_t old, int64_t id, const std::string&, Json& configuration) {
      if (number(fmt::format("SELECT count(*) FROM temp.left_edit WHERE id = {}", old)) > 0)
        configuration = left_behind();
      for (const char* key : {"undoes", "redoes"})
        if (configuration.contains(key)) configuration[key] = translated("run", configuration[key]);
      if (configuration.contains("last_scene"))
        configuration["last_scene"] = translated("scene", configuration["last_scene"]);
      if (configuration.contains("map"))
        for (const char* key : {"before", "after"})
          configuration["map"][key] = translated("map", configuration["map"].at(key));
      if (configuration.contains("label")) {
        Json& label = configuration["label"];
        label["scene"] = translated("scene", label.at("scene"));
        label["observation"] = translated("observation", label.at("observation"));
      }
      if (configuration.contains("identity"))
        for (Json& one : configuration["identity"]) {
          one["object"] = translated("object", one.at("object"));
          Json observations = Json::array();
          for (const Json& observation : one.at("observations"))
            if (!is_in_common_scene(observation))
              observations.push_back(translated("observation", observation));
          one["observations"] = observations;
        }
      change.bind(1, configuration.dump());
      change.bind(2, id);
      change.exec();
      change.reset();
    });
  }

  SQLite::Database& database_;
  fs::path first_, second_;
  std::optional<FrameChange> frame_;
  int64_t first_new_run_ = 0;
  MergeResult result_;
};

}  // namespace

MergeResult merge(const fs::path& first, const fs::path& second, const fs::path& output,
                  const std::optional<FrameChange>& frame, Progress& progress) {
  MergeResult result;
  create_verified(output, {first, second}, progress, [&](const fs::path& made) {
    const TemporaryMemory other(output);
    copy_migrated(first, made);
    copy_migrated(second, other.path());
    const int64_t forgotten = forget_in_both(made, other.path());
    try {
      const auto database = open_database(made.string(), SQLite::OPEN_READWRITE);
      trust_schema(*database);  // both are checked and migrated
      SQLite::Statement attach(*database, "ATTACH ? AS other");
      attach.bind(1, other.path().string());
      attach.exec();
      SQLite::Transaction all(*database, SQLite::TransactionBehavior::IMMEDIATE);
      result = Merger(*database, first, second, frame).run(progress);
      result.forgotten = forgotten;
      all.commit();
      database->exec("DETACH other");
      if (forgotten > 0) overwrite_deleted(*database);
      database->exec("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const SQLite::Exception& error) {
      throw_database_error(error, made);
    }
    { Store::open_write(made); }
  });
  return result;
}

}  // namespace loci::memory
