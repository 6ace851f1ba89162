// What is forgotten on request: which rows belong to it, and their removal.

#include <algorithm>
#include <cmath>
#include <random>

#include "mapping/base/hash.h"
#include "mapping/base/json.h"
#include "memory/store/derived_rows.h"
#include "memory/store/erased_images.h"
#include "memory/store/row_columns.h"

namespace loci::memory {
namespace {

constexpr const char* kBitemporalTables[] = {"association", "event", "object", "belief", "fact"};
constexpr const char* kSupersededTables[] = {"association", "event", "belief", "fact"};
constexpr const char* kMarkTables[] = {"gone_object", "gone_observation", "gone_scene",
                                       "gone_image",  "gone_association", "gone_event",
                                       "gone_belief", "gone_fact",        "gone_run"};

/// What is to go, by id.
struct Targets {
  std::set<Id> objects = {}, observations = {}, facts = {}, places = {};
  std::optional<std::pair<TimeNs, TimeNs>> interval = {};
};

/// What identifies an observation or a fact in every copy of a memory.
constexpr const char* kObservationIdentity =
    "SELECT o.id, o.scene, s.time, coalesce('recording ' || r.fingerprint || ' frame ' || s.frame_index, "
    "'time ' || "
    "s.time) AS scene_identity, o.number FROM observation o JOIN scene s ON s.id = o.scene LEFT JOIN "
    "recording r ON "
    "r.id = s.recording";
constexpr const char* kFactIdentity =
    "SELECT f.id, json_array(p.name, f.key, f.value, f.valid_from, f.known_from, f.source) AS identity FROM "
    "fact f "
    "JOIN place p ON p.id = f.place";

std::string observation_identity(const SqlRow& row) {
  return fmt::format("observation {} of {}", row.get<int64_t>("number"),
                     row.get<std::string>("scene_identity"));
}

/// Keyed, so that nobody can compare what two tombstones stand for.
std::string signature(const std::string& salt, const std::string& identity) {
  return content_hash(salt + content_hash(salt + identity));
}

/// Whatever else is the same in two runs, this must not be: it hides what it names.
std::string random_hex(int words) {
  std::random_device random;
  std::string hex;
  for (int i = 0; i < words; ++i) hex += fmt::format("{:08x}", random());
  return hex;
}

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

/// Erases targets inside a transaction.
class Eraser {
 public:
  Eraser(Store& store, Store::Connection& db, Targets targets, Id run)
      : store_(store), db_(db), database_(*db.database), targets_(std::move(targets)), run_(run) {}

  ForgetResult erase(const ReasoningFilter& filter) {
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

  /// Of what was erased, before.
  const std::vector<std::string>& identities() const { return identities_; }

 private:
  int64_t change(const std::string& text, const SqlValues& values = {}) {
    return run_statements(database_, text, values);
  }
  /// A condition on a column, e.g. "object IN (SELECT id FROM temp.gone_object)".
  static std::string is_gone(const std::string& column, const std::string& what) {
    return fmt::format("{} IN (SELECT id FROM temp.gone_{})", column, what);
  }
  TimeNs from() const { return targets_.interval->first; }
  TimeNs to() const { return targets_.interval->second; }

  // ---- What belongs to it.

  void mark() {
    const auto insert = [&](const char* table, const std::set<Id>& ids) {
      for (const Id id : ids)
        change(fmt::format("INSERT OR IGNORE INTO temp.gone_{} VALUES (?);", table), {sql(id)});
    };
    insert("object", targets_.objects);
    insert("observation", targets_.observations);
    insert("fact", targets_.facts);
    if (targets_.interval)
      change(
          "INSERT INTO temp.gone_scene SELECT id FROM scene WHERE time BETWEEN ?1 AND ?2;"
          "INSERT OR IGNORE INTO temp.gone_observation SELECT o.id FROM observation o WHERE o.scene IN "
          "(SELECT id FROM "
          "temp.gone_scene);",
          {sql(from()), sql(to())});
    while (mark_observations() + mark_emptied_objects() > 0) {
    }
    mark_rows();
    for (const char* table : kSupersededTables) mark_superseded(table);
    for (const Id id : db_.values<Id>("SELECT id FROM temp.gone_object")) result_.object_ids.insert(id);
    for (const Id id : db_.values<Id>("SELECT id FROM temp.gone_observation"))
      result_.observation_ids.insert(id);
    result_.objects = static_cast<int64_t>(result_.object_ids.size());
    result_.observations = static_cast<int64_t>(result_.observation_ids.size());
  }

  /// The observations that are associated with a gone object now, not those that once were.
  int64_t mark_observations() {
    return change(
        "INSERT OR IGNORE INTO temp.gone_observation SELECT observation FROM association_known WHERE "
        "known_to IS NULL "
        "AND chosen = 1 AND probability > 0 AND observation IS NOT NULL AND object IN (SELECT id FROM "
        "temp.gone_object);");
  }

  /// Objects that have no observation but gone ones: those that were merged into a gone object, too.
  int64_t mark_emptied_objects() {
    return change(
        "INSERT OR IGNORE INTO temp.gone_object SELECT DISTINCT a.object FROM association a WHERE a.chosen = "
        "1 AND "
        "a.object IS NOT NULL AND a.observation IN (SELECT id FROM temp.gone_observation) AND NOT EXISTS "
        "(SELECT 1 "
        "FROM association_known k WHERE k.object = a.object AND k.known_to IS NULL AND k.chosen = 1 AND "
        "k.probability "
        "> 0 AND k.observation IS NOT NULL AND k.observation NOT IN (SELECT id FROM "
        "temp.gone_observation));");
  }

  void mark_rows() {
    const std::string object = is_gone("object", "object"),
                      observation = is_gone("observation", "observation"), scene = is_gone("scene", "scene");
    change(fmt::format(
        "INSERT OR IGNORE INTO temp.gone_association SELECT id FROM association WHERE {} OR {} OR {};"
        "INSERT OR IGNORE INTO temp.gone_event SELECT id FROM event WHERE {} OR {} OR {};"
        "INSERT OR IGNORE INTO temp.gone_belief SELECT id FROM belief WHERE {} OR {} OR {} OR {};"
        "INSERT OR IGNORE INTO temp.gone_fact SELECT id FROM fact WHERE {};",
        object, observation, scene, object, observation, scene, object, scene,
        is_gone("last_observation", "observation"), is_gone("last_scene", "scene"), object));
    for (const Id place : targets_.places)
      change("INSERT OR IGNORE INTO temp.gone_fact SELECT id FROM fact WHERE place = ?;", {sql(place)});
    if (!targets_.interval) return;
    change(
        "INSERT OR IGNORE INTO temp.gone_event SELECT id FROM event WHERE valid_from BETWEEN ?1 AND ?2;"
        "INSERT OR IGNORE INTO temp.gone_fact SELECT id FROM fact WHERE valid_from BETWEEN ?1 AND ?2;",
        {sql(from()), sql(to())});
    // That it was gone later was seen later; where it had been before was seen in the interval.
    change(
        "DELETE FROM temp.gone_belief WHERE id IN (SELECT id FROM belief WHERE status = 'gone' AND scene IS "
        "NOT NULL "
        "AND scene NOT IN (SELECT id FROM temp.gone_scene) AND object NOT IN (SELECT id FROM "
        "temp.gone_object));");
  }

  /// Rows that gone ones supersede would hold again: they go as well, unless a remaining row superseded them
  /// in turn.
  void mark_superseded(const std::string& table) {
    const std::string gone = "(SELECT id FROM temp.gone_" + table + ")";
    if (targets_.interval && table == "fact")  // until then it held
      change(
          fmt::format(
              "UPDATE fact SET valid_to = ?1 WHERE id NOT IN {0} AND valid_from < ?1 AND (valid_to IS NULL "
              "OR valid_to > ?1) AND id IN (SELECT supersedes FROM fact WHERE id IN {0});",
              gone),
          {sql(from())});
    const std::string relink = fmt::format(
        "UPDATE {0} SET supersedes = (SELECT g.supersedes FROM {0} g WHERE g.id = {0}.supersedes) WHERE id "
        "NOT IN {1} "
        "AND supersedes IN {1};",
        table, gone);
    const std::string follow = fmt::format(
        "INSERT OR IGNORE INTO temp.gone_{0} SELECT t.id FROM {0} t WHERE t.id NOT IN {1} AND t.id IN "
        "(SELECT "
        "supersedes FROM {0} WHERE id IN {1}) AND NOT EXISTS (SELECT 1 FROM {0} b WHERE b.supersedes = t.id "
        "AND b.id "
        "NOT IN {1}){2};",
        table, gone,
        targets_.interval && table == "fact" ? fmt::format(" AND t.valid_from >= {}", from()) : "");
    do {
      while (change(relink) > 0) {
      }
    } while (change(follow) > 0);
  }

  /// Runs of people's edits whose rows or text are about it, and those that undo or redo them.
  void mark_runs() {
    std::map<Id, Json> edits;
    std::set<Id> gone;
    db_.query(
        "SELECT id, configuration FROM run WHERE program LIKE 'loci-memory edit%' OR program LIKE "
        "'loci-memory fact%'",
        {}, [&](const SqlRow& row) {
          edits[row.get<Id>("id")] = parse_json(row.get<std::string>("configuration"), "run.configuration");
        });
    for (const char* table : kSupersededTables)
      for (const Id run :
           db_.values<Id>(fmt::format("SELECT DISTINCT run FROM {} WHERE {}", table, is_gone("id", table))))
        if (edits.contains(run)) gone.insert(run);
    for (const auto& [run, configuration] : edits)
      if (mentions(configuration)) gone.insert(run);
    for (size_t before = 0; before != gone.size();) {
      before = gone.size();
      for (const auto& [run, configuration] : edits)
        for (const char* key : {"undoes", "redoes"}) {
          if (!configuration.contains(key)) continue;
          const Id other = configuration[key].get<Id>();
          if (gone.contains(other)) gone.insert(run);
          if (gone.contains(run)) gone.insert(other);
        }
    }
    for (const Id run : gone) {
      change("INSERT INTO temp.gone_run VALUES (?);", {sql(run)});
      if (edits.contains(run)) collect_strings(edits[run]);
    }
  }

  bool mentions(const Json& configuration) const {
    const auto is = [](const Json& value, const std::set<Id>& ids) {
      return value.is_number_integer() && ids.contains(value.get<Id>());
    };
    if (configuration.contains("label") &&
        is(configuration["label"].value("observation", Json()), result_.observation_ids))
      return true;
    if (configuration.contains("split"))
      for (const char* key : {"object", "new"})
        if (is(configuration["split"].value(key, Json()), result_.object_ids)) return true;
    const std::string text = configuration.contains("text") && configuration["text"].is_string()
                                 ? configuration["text"].get<std::string>()
                                 : std::string();
    return std::ranges::any_of(result_.object_ids, [&](Id object) {
      const std::string name = object_name(object);
      for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
        if (at + name.size() == text.size() ||
            std::isdigit(static_cast<unsigned char>(text[at + name.size()])) == 0)
          return true;
      return false;
    });
  }

  // ---- What must not be found afterwards.

  void read_signatures() {
    if (targets_.interval) return;
    db_.query(fmt::format("{} WHERE {} ORDER BY o.id", kObservationIdentity, is_gone("o.id", "observation")),
              {}, [&](const SqlRow& row) { identities_.push_back(observation_identity(row)); });
    db_.query(fmt::format("{} WHERE {} ORDER BY f.id", kFactIdentity, is_gone("f.id", "fact")), {},
              [&](const SqlRow& row) { identities_.push_back(row.get<std::string>("identity")); });
  }

  void collect(const std::string& query) {
    change(fmt::format("INSERT OR IGNORE INTO temp.said {};", query));
  }
  void collect_strings(const Json& json) {
    if (json.is_string())
      change("INSERT OR IGNORE INTO temp.said VALUES (?);", {sql(json.get_ref<const std::string&>())});
    if (json.is_structured())
      for (const Json& part : json) collect_strings(part);
  }

  void collect_texts() {
    const std::string observation = is_gone("observation", "observation"), id = is_gone("id", "observation");
    collect(fmt::format("SELECT t.value FROM annotation a JOIN term t ON t.id = a.term WHERE {} OR {}",
                        "a." + observation, is_gone("a.scene", "scene")));
    collect(fmt::format("SELECT location FROM observation WHERE location IS NOT NULL AND {}", id));
    collect(fmt::format("SELECT value FROM fact WHERE value IS NOT NULL AND {}", is_gone("id", "fact")));
  }

  void collect_numbers() {
    for (const char* column : {"x", "y"})
      for (const double number : db_.values<double>(
               fmt::format("SELECT DISTINCT {0} FROM observation WHERE {0} IS NOT NULL AND {1}", column,
                           is_gone("id", "observation"))))
        if (std::round(number * 1e4) / 1e4 != number)  // of those that people type, others are the same
          result_.tokens.numbers.push_back(number);
  }

  void erase_images() {
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

  /// Which of these are gone is known when all is done.
  void remember_blobs() { change("INSERT OR IGNORE INTO temp.stored SELECT hash FROM blob;"); }

  // ---- Removal.

  void filter_reasoning(const ReasoningFilter& filter) {
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

  /// What later rows say of the interval: since when, where from, and where an object had been that is gone
  /// now.
  void correct_rows_after_interval() {
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

  /// Deletes rows and counts them.
  void remove(const std::string& table, const std::string& condition) {
    result_.erased[table] += change(fmt::format("DELETE FROM {} WHERE {};", table, condition));
  }

  void delete_rows() {
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
    for (const char* table : kSupersededTables) remove(table, is_gone("id", table));
    remove("visibility", is_gone("object", "object") + " OR " + scene);
    // About a scene as a whole: a text, or an obstacle, may be of the object.
    const std::string of_image = "observation IS NULL AND " + is_gone("scene", "image");
    remove("annotation", observation + " OR " + scene + " OR " + of_image);
    const std::string structures = fmt::format(
        "{} OR {} OR ({} AND type NOT IN ('loci.cv.CameraInfo', 'loci.tf.JointState', 'loci.PlanarSupport', "
        "'loci.JointAnnotation'))",
        observation, scene, of_image);
    change(fmt::format(
        "UPDATE annotation SET feature_structure = NULL WHERE feature_structure IN (SELECT id FROM "
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

  /// Runs that nothing refers to go; of others what they were configured with.
  void delete_runs() {
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
    change(fmt::format("UPDATE run SET configuration = '{{\"forgotten\":true}}' WHERE {};",
                       is_gone("id", "run")));
  }

  // ---- Objects of which some observations remain.

  void restore_remaining_objects() {
    std::vector<std::pair<Id, TimeNs>> changed;
    db_.query("SELECT id, since FROM temp.changed_object ORDER BY id", {},
              [&](const SqlRow& row) { changed.emplace_back(row.get<Id>("id"), row.get<TimeNs>("since")); });
    for (const auto& [object, since] : changed) restore_object(object, since);
    db_.statements.clear();
  }

  void restore_object(Id object, TimeNs since) {
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
      believe_observation(
          object, *db_.value<Id>("SELECT observation " + observed + " ORDER BY valid_from DESC LIMIT 1",
                                 {sql(object)}));
  }

  void add_appearance(Id object, Id observation) {
    change(
        "INSERT INTO event (scene, kind, object, observation, place, x, y, z, probability, valid_from, "
        "valid_to, "
        "known_from, run, source) SELECT o.scene, 'appeared', ?1, o.id, o.place, o.x, o.y, o.z, 1, s.time, "
        "s.time, ?3, "
        "?4, 'forget' FROM observation o JOIN scene s ON s.id = o.scene WHERE o.id = ?2;",
        {sql(object), sql(observation), sql(db_.known_time()), sql(run_)});
  }

  /// A row of belief from an observation, unless there is one of its scene.
  void believe_observation(Id object, Id observation) {
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

  void remember_next_object() {
    const Id last = result_.object_ids.empty() ? 0 : *result_.object_ids.rbegin();
    change(
        "INSERT INTO meta (key, value) VALUES ('next_object', ?1) ON CONFLICT DO UPDATE SET value = "
        "excluded.value WHERE "
        "CAST(value AS INTEGER) < excluded.value;",
        {sql(std::max(last + 1, db_.next_object_id()))});
    db_.statements.clear();
  }

  // ---- Tokens: what nothing that remains says.

  void finish_tokens() {
    constexpr size_t kMinLength = 5;  // shorter ones occur by chance
    const std::string documents = stored_documents();
    for (const std::string& text : db_.values<std::string>("SELECT value FROM temp.said ORDER BY value"))
      if (text.size() >= kMinLength && documents.find(text) == std::string::npos && !is_said(text))
        result_.tokens.texts.push_back(text);
    result_.tokens.hashes = db_.values<std::string>(
        "SELECT hash FROM temp.stored WHERE hash NOT IN (SELECT hash FROM blob) ORDER BY hash");
    result_.erased["blob"] = static_cast<int64_t>(result_.tokens.hashes.size());
    std::erase_if(result_.tokens.numbers, [&](double number) {
      for (const char* table : {"observation", "belief", "event"})
        if (db_.value<Id>(fmt::format("SELECT id FROM {} WHERE x = ?1 OR y = ?1 LIMIT 1", table),
                          {sql(number)}))
          return true;
      return false;
    });
    std::erase_if(result_.erased, [](const auto& kind) { return kind.second == 0; });
    db_.statements.clear();
  }

  /// Maps and type systems, which are about the home and the program.
  std::string stored_documents() {
    std::string all;
    for (const Id blob : db_.values<Id>("SELECT urdf FROM map UNION SELECT sidecar FROM map WHERE sidecar IS "
                                        "NOT NULL UNION SELECT content FROM "
                                        "type_system"))
      all += store_.blob(blob).bytes;
    return all;
  }

  bool is_said(const std::string& text) {
    return db_
        .value<int64_t>(
            "SELECT 1 FROM (SELECT value FROM term UNION ALL SELECT value FROM fact UNION ALL SELECT name "
            "FROM place UNION "
            "ALL SELECT class FROM place UNION ALL SELECT text FROM scene_log UNION ALL SELECT location FROM "
            "observation "
            "UNION ALL SELECT color FROM observation UNION ALL SELECT color FROM belief UNION ALL SELECT "
            "name FROM "
            "recording UNION ALL SELECT configuration FROM run UNION ALL SELECT program FROM run UNION ALL "
            "SELECT sql FROM "
            "sqlite_schema) WHERE instr(value, ?1) > 0 LIMIT 1",
            {sql(text)})
        .has_value();
  }

  Store& store_;
  Store::Connection& db_;
  SQLite::Database& database_;
  Targets targets_;
  Id run_;
  ForgetResult result_;
  std::vector<std::string> identities_;
};

void add_tombstone(Store::Connection& db, const Targets& targets, const std::vector<std::string>& identities,
                   Id run) {
  std::random_device random;
  const Id id = static_cast<Id>((uint64_t{random()} << 31 ^ random()) & 0x3fffffffffffffff) + 1;
  const std::string salt = random_hex(8);
  const auto time = [&](bool last) {
    return targets.interval ? sql(last ? targets.interval->second : targets.interval->first) : SqlValue();
  };
  db.run("INSERT INTO forgotten (id, salt, valid_from, valid_to, known_from, run) VALUES (?, ?, ?, ?, ?, ?)",
         {sql(id), sql(salt), time(false), time(true), sql(db.known_time()), sql(run)});
  for (const std::string& identity : identities) {
    const std::string keyed = signature(salt, identity);
    db.run("INSERT OR IGNORE INTO forgotten_signature (forgotten, signature) VALUES (?, ?)",
           {sql(id), sql(keyed)});
  }
}

/// Runs `body` in a transaction in which rows may refer to ones that are gone already, then overwrites them.
template <class Body>
auto erasing(Store::Connection& db, Body body) {
  return db.guarded([&] {
    SQLite::Database& database = *db.database;
    db.statements.clear();
    db.clear_caches();
    database.exec("PRAGMA secure_delete = ON; PRAGMA foreign_keys = OFF");
    try {
      SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
      auto result = body();
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

std::set<std::string> scene_identities(Store::Connection& db) {
  std::set<std::string> scenes;
  db.query(std::string(kObservationIdentity), {},
           [&](const SqlRow& row) { scenes.insert(row.get<std::string>("scene_identity")); });
  db.query(
      "SELECT coalesce('recording ' || r.fingerprint || ' frame ' || s.frame_index, 'time ' || s.time) AS "
      "identity FROM "
      "scene s LEFT JOIN recording r ON r.id = s.recording",
      {}, [&](const SqlRow& row) { scenes.insert(row.get<std::string>("identity")); });
  return scenes;
}

/// What a memory has of what a tombstone of another stands for.
Targets targets_of(Store::Connection& db, const std::string& salt, const std::set<std::string>& signatures,
                   const std::set<std::string>& common_scenes) {
  Targets targets;
  std::map<Id, bool> is_common;  ///< of observations
  db.query(std::string(kObservationIdentity), {}, [&](const SqlRow& row) {
    const Id id = row.get<Id>("id");
    is_common[id] = common_scenes.contains(row.get<std::string>("scene_identity"));
    if (signatures.contains(signature(salt, observation_identity(row)))) targets.observations.insert(id);
  });
  db.query(std::string(kFactIdentity), {}, [&](const SqlRow& row) {
    if (signatures.contains(signature(salt, row.get<std::string>("identity"))))
      targets.facts.insert(row.get<Id>("id"));
  });
  if (targets.observations.empty()) return targets;
  std::map<Id, std::pair<int, int>> counts;  ///< per object: forgotten, and in common scenes
  db.query(
      "SELECT object, observation FROM association_known WHERE known_to IS NULL AND chosen = 1 AND "
      "probability > 0 AND "
      "observation IS NOT NULL AND object IS NOT NULL",
      {}, [&](const SqlRow& row) {
        const Id observation = row.get<Id>("observation");
        auto& [gone, common] = counts[row.get<Id>("object")];
        gone += targets.observations.contains(observation) ? 1 : 0;
        common += is_common[observation] ? 1 : 0;
      });
  for (const auto& [object, count] : counts)
    if (2 * count.first > count.second && count.first > 0) targets.objects.insert(object);
  return targets;
}

}  // namespace

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

ForgetResult Store::forget(const ForgetRequest& request, Id run, const ReasoningFilter& filter) {
  auto& db = *connection_;
  db.require_writable();
  Targets targets;
  if (request.object) targets.objects.insert(*request.object);
  if (request.place) targets.places.insert(*request.place);
  if (request.from && request.to) targets.interval = {*request.from, *request.to};
  const int named =
      int(request.object.has_value()) + int(request.place.has_value()) + int(targets.interval.has_value());
  if (named != 1) throw error("nothing to forget is named", "name an object, a place, or two times");
  if (targets.interval && targets.interval->first > targets.interval->second)
    throw error("the first time is after the second", "write --between EARLIER LATER");
  return erasing(db, [&] {
    Eraser eraser(*this, db, targets, run);
    ForgetResult result = eraser.erase(filter);
    add_tombstone(db, targets, eraser.identities(), run);
    return result;
  });
}

ForgetResult Store::honour_tombstones(const Store& younger) {
  Connection &db = *connection_, &other = *younger.connection_;
  struct Tombstone {
    Id id = 0;
    std::string salt = {};
    std::optional<TimeNs> from = {}, to = {};
  };
  std::vector<Tombstone> tombstones;
  other.query("SELECT * FROM forgotten ORDER BY known_from, id", {}, [&](const SqlRow& row) {
    tombstones.push_back({row.get<Id>("id"), row.get<std::string>("salt"),
                          row.get<std::optional<TimeNs>>("valid_from"),
                          row.get<std::optional<TimeNs>>("valid_to")});
  });
  ForgetResult result;
  if (tombstones.empty()) return result;
  const std::set<std::string> common_scenes = scene_identities(other);
  std::optional<Id> run;
  for (const Tombstone& tombstone : tombstones) {
    if (db.value<Id>("SELECT id FROM forgotten WHERE id = ?", {sql(tombstone.id)})) continue;
    Targets targets;
    if (tombstone.from) {
      targets.interval = {*tombstone.from, *tombstone.to};
    } else {
      const auto signatures = other.values<std::string>(
          "SELECT signature FROM forgotten_signature WHERE forgotten = ?", {sql(tombstone.id)});
      targets = targets_of(db, tombstone.salt, {signatures.begin(), signatures.end()}, common_scenes);
      if (targets.observations.empty() && targets.facts.empty()) continue;
    }
    if (!run) run = begin_run("loci-memory merge", "{}");
    const ForgetResult erased = erasing(db, [&] {
      const ForgetResult one = Eraser(*this, db, targets, *run).erase({});
      // The belief has it too; it begins anew from the rows.
      run_statements(
          *db.database,
          "DELETE FROM checkpoint WHERE name = 'belief' OR name LIKE 'belief/%' OR name LIKE 'before/%';");
      return one;
    });
    result.objects += erased.objects;
    result.observations += erased.observations;
    result.scenes += erased.scenes;
  }
  if (run) finish_run(*run);
  return result;
}

bool was_forgotten(const std::vector<ForgottenRow>& rows, TimeNs time) {
  return std::ranges::any_of(rows, [&](const ForgottenRow& row) {
    return row.valid_from && *row.valid_from <= time && time <= *row.valid_to;
  });
}

std::vector<ForgottenRow> Store::forgotten() const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::vector<ForgottenRow> rows;
    db.query("SELECT * FROM forgotten ORDER BY known_from, id", {}, [&](const SqlRow& row) {
      rows.push_back({row.get<Id>("id"), row.get<std::optional<TimeNs>>("valid_from"),
                      row.get<std::optional<TimeNs>>("valid_to"), row.get<TimeNs>("known_from")});
    });
    return rows;
  });
}

}  // namespace loci::memory
