// What is forgotten on request: its removal.

#include "memory/store/erasure/erasure.h"
#include <algorithm>
#include "memory/store/erasure/erased_images.h"
#include "memory/store/rows/derived_rows.h"

namespace loci::memory {
namespace {

constexpr const char* kBitemporalTables[] = {"association", "event", "object", "belief", "fact"};
constexpr const char* kMarkTables[] = {"gone_object", "gone_observation", "gone_scene",
                                       "gone_image",  "gone_association", "gone_event",
                                       "gone_belief", "gone_fact",        "gone_run"};

/// Rows that may only be added are changed while this lives. Also the tables of what is marked.
class ErasureTables {
 public:
  explicit ErasureTables(Store::Connection& db) : database_(*db.database) {
    triggers_ = db.values<std::string>(
        "SELECT sql FROM sqlite_schema WHERE type = 'trigger' AND name LIKE '%_append_only'");
    db.statements.clear();
    for (const char* table : kBitemporalTables)
      database_.exec(fmt::format("DROP TRIGGER {}_append_only", table));
    for (const char* table : kMarkTables)
      database_.exec(fmt::format(
          "DROP TABLE IF EXISTS temp.{0}; CREATE TEMP TABLE {0} (id INTEGER PRIMARY KEY)", table));
    database_.exec(
        "DROP TABLE IF EXISTS temp.said; CREATE TEMP TABLE said (value TEXT PRIMARY KEY);"
        "DROP TABLE IF EXISTS temp.stored; CREATE TEMP TABLE stored (hash TEXT PRIMARY KEY);"
        "DROP TABLE IF EXISTS temp.changed_object; CREATE TEMP TABLE changed_object (id INTEGER PRIMARY KEY, "
        "since "
        "INTEGER NOT NULL)");
  }
  /// After the last change; without it the transaction is rolled back anyway.
  void restore() {
    for (const char* table : kMarkTables) database_.exec(fmt::format("DROP TABLE temp.{}", table));
    database_.exec("DROP TABLE temp.said; DROP TABLE temp.stored; DROP TABLE temp.changed_object");
    for (const std::string& trigger : triggers_) database_.exec(trigger);
  }

 private:
  SQLite::Database& database_;
  std::vector<std::string> triggers_;
};

}  // namespace

ForgetResult Eraser::erase(const ReasoningFilter& filter) {
  ErasureTables tables(db_);
  mark();
  read_signatures();
  collect_texts();
  collect_numbers();
  erase_images();
  filter_reasoning(filter);
  mark_runs();
  if (targets_.interval) correct_rows_after_interval();
  delete_rows();
  restore_remaining_objects();
  run_statements(database_, "DELETE FROM term WHERE id NOT IN (SELECT term FROM annotation);");
  drop_unused_blobs(database_);
  remember_next_object();
  derive_tables(database_);
  finish_tokens();
  tables.restore();
  return std::move(result_);
}

std::set<Id> Eraser::replace_superseded() {
  ErasureTables tables(db_);
  for (const char* table : {"event", "belief"}) replace_superseded_rows(table);
  replace_visibility();
  std::set<Id> emptied = hand_over_emptied_objects();
  db_.statements.clear();
  derive_tables(database_);
  tables.restore();
  return emptied;
}

std::set<Id> Eraser::hand_over_emptied_objects() {
  std::set<Id> emptied;
  for (const Id object :
       db_.values<Id>("SELECT id FROM object WHERE id NOT IN (SELECT object FROM belief)")) {
    emptied.insert(object);
    if (const std::optional<Id> other = store_.object_instead_of(object))
      change("UPDATE fact SET object = ?1 WHERE object = ?2;", {sql(*other), sql(object)});
  }
  return emptied;
}

void Eraser::replace_superseded_rows(const std::string& table) {
  const std::string gone = fmt::format("(SELECT id FROM temp.gone_{})", table);
  change(fmt::format("INSERT INTO temp.gone_{0} SELECT DISTINCT supersedes FROM {0} WHERE run = ?1 AND "
                     "supersedes IS NOT NULL;"
                     "UPDATE {0} AS n SET (known_from, supersedes) = (SELECT o.known_from, o.supersedes FROM "
                     "{0} o WHERE o.id = n.supersedes) WHERE run = ?1 AND supersedes IN {1};"
                     "DELETE FROM {0} WHERE id IN {1};"
                     "DELETE FROM temp.gone_{0};"
                     "INSERT INTO temp.gone_{0} SELECT id FROM {0} WHERE run = ?1 AND known_to IS NOT NULL;",
                     table, gone),
         {sql(run_)});
  retract_superseded(table);
  change(fmt::format("DELETE FROM {} WHERE id IN {};", table, gone));
}

/// Of an object and a scene the newest row holds, and one with out_of_view stands for none.
void Eraser::replace_visibility() {
  const std::string older =
      "FROM visibility o WHERE o.run <> ?1 AND o.scene = n.scene AND o.object = n.object";
  change(fmt::format(
             "UPDATE visibility AS n SET known_from = coalesce((SELECT min(o.known_from) {0}), known_from) "
             "WHERE run = ?1 AND object IS NOT NULL;"
             "DELETE FROM visibility WHERE id IN (SELECT o.id FROM visibility n JOIN visibility o ON o.scene "
             "= n.scene AND o.object = n.object AND o.run <> ?1 WHERE n.run = ?1);"
             "DELETE FROM visibility WHERE run = ?1 AND object IS NOT NULL AND status = 'out_of_view';",
             older),
         {sql(run_)});
}

void Eraser::erase_images() {
  if (targets_.interval) {
    change("INSERT INTO temp.gone_image SELECT id FROM temp.gone_scene;");
    result_.scenes = query_integer(database_, "SELECT count(*) FROM temp.gone_image");
    remember_blobs();
    return;
  }
  remember_blobs();
  ErasedImages images = erase_from_images(store_, db_);
  result_.scenes = images.scenes;
  result_.erased["image region"] = images.regions;
  result_.erased["image"] = images.images;
  result_.tokens.images = std::move(images.signatures);
  collect(fmt::format(
      "SELECT t.value FROM annotation a JOIN term t ON t.id = a.term WHERE a.observation IS NULL AND {}",
      is_gone("a.scene", "image")));
}

void Eraser::filter_reasoning(const ReasoningFilter& filter) {
  const auto first = db_.value<std::optional<TimeNs>>(
      fmt::format("SELECT min(s.time) FROM observation o JOIN scene s ON s.id = o.scene WHERE {}",
                  is_gone("o.id", "observation")));
  result_.erased["reasoning"] =
      change(fmt::format("DELETE FROM reasoning WHERE {};", is_gone("scene", "scene")));
  if (!first || !*first) return;
  if (!filter) {
    result_.erased["reasoning"] += change(
        "DELETE FROM reasoning WHERE scene IN (SELECT id FROM scene WHERE time >= ?);", {sql(**first)});
    return;
  }
  for (const Id scene : db_.values<Id>("SELECT scene FROM reasoning WHERE length(content) > 0")) {
    ErasedFromScene erased{.objects = result_.object_ids};
    erased.observations =
        db_.values<Id>("SELECT id FROM observation WHERE scene = ? ORDER BY number", {sql(scene)});
    for (const Id id : erased.observations)
      if (result_.observation_ids.contains(id)) erased.erased.insert(id);
    const std::optional<std::string> bytes = store_.reasoning(scene);
    const std::optional<std::string> rest = bytes ? filter(*bytes, erased) : std::nullopt;
    if (!rest) {
      result_.erased["reasoning"] += change("DELETE FROM reasoning WHERE scene = ?;", {sql(scene)});
    } else if (*rest != *bytes) {
      const Encoded encoded = encode_bytes(*rest);
      change("UPDATE reasoning SET encoding = ?1, content = ?2 WHERE scene = ?3;",
             {sql(encoded.encoding), BytesView{encoded.bytes}, sql(scene)});
    }
  }
  db_.statements.clear();
}

void Eraser::correct_rows_after_interval() {
  const std::string last_before =
      "(SELECT max(time) FROM scene WHERE time < ?1 AND NOT EXISTS (SELECT 1 FROM forgotten f WHERE "
      "scene.time BETWEEN "
      "f.valid_from AND f.valid_to))";
  change(fmt::format(
             "UPDATE event SET since = {}, from_place = NULL, from_x = NULL, from_y = NULL, from_z = NULL, "
             "from_position = NULL WHERE since BETWEEN ?1 AND ?2 AND id NOT IN (SELECT id FROM "
             "temp.gone_event);",
             last_before),
         {sql(from()), sql(to())});
  change(
      "UPDATE belief SET (place, x, y, z, sigma, hue, saturation, value, color, size_x, size_y, size_z, "
      "last_scene, "
      "last_observation) = (SELECT b.place, b.x, b.y, b.z, b.sigma, b.hue, b.saturation, b.value, b.color, "
      "b.size_x, "
      "b.size_y, b.size_z, b.last_scene, b.last_observation FROM belief b WHERE b.object = belief.object "
      "AND "
      "b.valid_from < ?1 AND b.id NOT IN (SELECT id FROM temp.gone_belief) ORDER BY b.valid_from DESC, "
      "b.id DESC "
      "LIMIT 1) WHERE status = 'gone' AND last_scene IN (SELECT id FROM temp.gone_scene) AND id NOT IN "
      "(SELECT id "
      "FROM temp.gone_belief);"
      "UPDATE fact SET valid_to = ?1 WHERE valid_from < ?1 AND valid_to BETWEEN ?1 AND ?2;",
      {sql(from()), sql(to())});
}

void Eraser::remove(const std::string& table, const std::string& condition) {
  result_.erased[table] += change(fmt::format("DELETE FROM {} WHERE {};", table, condition));
}

void Eraser::delete_rows() {
  const std::string observation = is_gone("observation", "observation"), scene = is_gone("scene", "scene");
  change(
      fmt::format("INSERT OR IGNORE INTO temp.changed_object SELECT object, min(valid_from) FROM belief "
                  "WHERE {} AND object NOT IN "
                  "(SELECT id FROM temp.gone_object) GROUP BY object;"
                  "INSERT INTO temp.changed_object SELECT object, min(valid_from) FROM association WHERE "
                  "{} AND chosen = 1 AND "
                  "object IS NOT NULL AND object NOT IN (SELECT id FROM temp.gone_object) GROUP BY object "
                  "ON CONFLICT DO UPDATE "
                  "SET since = min(since, excluded.since);",
                  is_gone("id", "belief"), is_gone("id", "association")));
  for (const char* table : {"association", "event", "belief", "fact"}) remove(table, is_gone("id", table));
  remove("visibility", is_gone("object", "object") + " OR " + scene);
  // About a scene as a whole: a text, or an obstacle, may be of the object.
  const std::string of_image = "observation IS NULL AND " + is_gone("scene", "image");
  remove("annotation", observation + " OR " + scene + " OR " + of_image);
  const std::string structures = fmt::format(
      "{} OR {} OR ({} AND type NOT IN ('loci.cv.CameraInfo', 'loci.tf.JointState', 'loci.PlanarSupport', "
      "'loci.JointAnnotation'))",
      observation, scene, of_image);
  change(
      fmt::format("UPDATE annotation SET feature_structure = NULL WHERE feature_structure IN (SELECT id FROM "
                  "feature_structure WHERE {0});"
                  "DELETE FROM feature_structure_blob WHERE feature_structure IN (SELECT id FROM "
                  "feature_structure WHERE {0});",
                  structures));
  remove("feature_structure", structures);
  remove("observation", is_gone("id", "observation"));
  remove("object", is_gone("id", "object"));
  remove("scene_log", scene);
  change(fmt::format("UPDATE scene_log SET text = NULL WHERE {};", is_gone("scene", "image")));
  change(fmt::format(
      "UPDATE scene SET image = NULL, depth = NULL, depth_width = NULL, depth_height = NULL, pixel_kinds = "
      "NULL, joints "
      "= NULL, x = NULL, y = NULL, z = NULL, qx = NULL, qy = NULL, qz = NULL, qw = NULL WHERE {};",
      is_gone("id", "scene")));
  delete_runs();
}

void Eraser::delete_runs() {
  std::string used;
  db_.query(
      "SELECT t.name AS name, f.\"from\" AS \"column\" FROM sqlite_schema t, "
      "pragma_foreign_key_list(t.name) f WHERE "
      "t.type = 'table' AND f.\"table\" = 'run'",
      {}, [&](const SqlRow& row) {
        used += fmt::format("{}SELECT {} FROM {}", used.empty() ? "" : " UNION ",
                            row.get<std::string>("column"), row.get<std::string>("name"));
      });
  remove("run", fmt::format("{} AND id NOT IN ({})", is_gone("id", "run"), used));
  change(
      fmt::format("UPDATE run SET configuration = '{{\"forgotten\":true}}' WHERE {};", is_gone("id", "run")));
}

void Eraser::restore_remaining_objects() {
  std::vector<std::pair<Id, TimeNs>> changed;
  db_.query("SELECT id, since FROM temp.changed_object ORDER BY id", {},
            [&](const SqlRow& row) { changed.emplace_back(row.get<Id>("id"), row.get<TimeNs>("since")); });
  for (const auto& [object, since] : changed) restore_object(object, since);
  db_.statements.clear();
}

void Eraser::restore_object(Id object, TimeNs since) {
  const std::string observed =
      "FROM association_known WHERE object = ?1 AND known_to IS NULL AND chosen = 1 AND probability > 0 "
      "AND observation "
      "IS NOT NULL";
  const auto first =
      db_.value<Id>("SELECT observation " + observed + " ORDER BY valid_from LIMIT 1", {sql(object)});
  if (!first) return;
  const TimeNs begins = *db_.value<TimeNs>(
      "SELECT s.time FROM observation o JOIN scene s ON s.id = o.scene WHERE o.id = ?", {sql(*first)});
  if (change("UPDATE object SET valid_from = ?2 WHERE id = ?1 AND valid_from < ?2;",
             {sql(object), sql(begins)}) > 0) {
    for (const char* table : {"event", "belief", "visibility"})
      remove(table, fmt::format("object = {} AND valid_from < {}", object, begins));
    for (const char* table : {"event", "belief"})
      change(fmt::format(
          "UPDATE {0} SET supersedes = NULL WHERE supersedes IS NOT NULL AND supersedes NOT IN (SELECT "
          "id FROM {0});",
          table));
    if (!db_.value<Id>("SELECT id FROM event WHERE object = ?1 AND valid_from = ?2",
                       {sql(object), sql(begins)}))
      add_appearance(object, *first);
  }
  // The belief that the erased observations had led to is found again from the first that remains.
  const auto next =
      db_.value<Id>("SELECT observation " + observed + " AND valid_from >= ?2 ORDER BY valid_from LIMIT 1",
                    {sql(object), sql(since)});
  if (next) believe_observation(object, *next);
  if (!db_.value<Id>("SELECT id FROM belief WHERE object = ?", {sql(object)}))
    believe_observation(object,
                        *db_.value<Id>("SELECT observation " + observed + " ORDER BY valid_from DESC LIMIT 1",
                                       {sql(object)}));
}

void Eraser::add_appearance(Id object, Id observation) {
  change(
      "INSERT INTO event (scene, kind, object, observation, place, x, y, z, probability, valid_from, "
      "valid_to, "
      "known_from, run, source) SELECT o.scene, 'appeared', ?1, o.id, o.place, o.x, o.y, o.z, 1, s.time, "
      "s.time, ?3, "
      "?4, 'forget' FROM observation o JOIN scene s ON s.id = o.scene WHERE o.id = ?2;",
      {sql(object), sql(observation), sql(db_.known_time()), sql(run_)});
}

void Eraser::believe_observation(Id object, Id observation) {
  change(
      "INSERT INTO belief (object, scene, status, probability, place, x, y, z, last_scene, "
      "last_observation, hue, "
      "saturation, value, color, size_x, size_y, size_z, valid_from, known_from, run, source) SELECT ?1, "
      "o.scene, "
      "'seen', 1, o.place, o.x, o.y, o.z, o.scene, o.id, o.hue, o.saturation, o.value, o.color, o.size_x, "
      "o.size_y, "
      "o.size_z, s.time, ?3, ?4, 'forget' FROM observation o JOIN scene s ON s.id = o.scene WHERE o.id = "
      "?2 AND NOT "
      "EXISTS (SELECT 1 FROM belief b WHERE b.object = ?1 AND b.scene = o.scene);",
      {sql(object), sql(observation), sql(db_.known_time()), sql(run_)});
}

void Eraser::remember_next_object() {
  const Id last = result_.object_ids.empty() ? 0 : *result_.object_ids.rbegin();
  change(
      "INSERT INTO meta (key, value) VALUES ('next_object', ?1) ON CONFLICT DO UPDATE SET value = "
      "excluded.value WHERE "
      "CAST(value AS INTEGER) < excluded.value;",
      {sql(std::max(last + 1, db_.next_object_id()))});
  db_.statements.clear();
}

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

}  // namespace loci::memory
