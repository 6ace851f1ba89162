#include "memory/store/rows/derived_rows.h"

#include <algorithm>
#include <array>

#include "memory/store/rows/digest.h"

namespace loci::memory {
namespace {

/// Scenes and observations of an object are ranked by time; every 64th has a row with its rank.
constexpr int64_t kRankStep = 64;

/// A table and the query that its rows follow from. {observed} = kObserved, {step} = kRankStep, {filter} =
/// empty, or " AND object = ?1" where it is derived for one object; {known} = kKnownBelief.
struct DerivedTable {
  const char* name;
  const char* columns;
  const char* select;
  const char* subject;  ///< the column that problems name
};

constexpr DerivedTable kSceneRank = {"scene_rank", "number, time, scene",
                                     "SELECT number, time, id AS scene FROM (SELECT id, time, row_number() "
                                     "OVER (ORDER BY time, id) AS number FROM "
                                     "scene) WHERE number % {step} = 1",
                                     "scene"};
constexpr DerivedTable kObservationRank = {
    "observation_rank", "object, number, valid_from, scene",
    "SELECT object, number, valid_from, scene FROM (SELECT object, valid_from, scene, row_number() OVER "
    "(PARTITION BY object ORDER BY valid_from, scene) AS number FROM association WHERE {observed} AND object "
    "IS NOT "
    "NULL{filter}) WHERE number % {step} = 1",
    "object"};
constexpr DerivedTable kVisit = {
    "visit", "object, valid_from, scene, place",
    // Of several rows of one object in a scene the last one holds: it superseded the others.
    "SELECT object, valid_from, scene, place FROM (SELECT object, valid_from, scene, place, lag(place) OVER "
    "(PARTITION BY object ORDER BY valid_from, scene) AS place_before FROM (SELECT object, a.valid_from, "
    "a.scene, coalesce(o.place, 0) AS place, max(a.id) FROM association a JOIN observation o ON o.id = "
    "a.observation WHERE {observed} AND object IS NOT NULL{filter} GROUP BY object, a.valid_from, a.scene)) "
    "WHERE place_before IS NOT place",
    "object"};
constexpr DerivedTable kObjectTerm = {
    "object_term", "term, object, since",
    "SELECT n.term, a.object, min(a.valid_from) AS since FROM (SELECT object, observation, scene, valid_from "
    "FROM "
    "association WHERE {observed} AND object IS NOT NULL{filter}) a JOIN annotation n ON n.scene = a.scene "
    "AND "
    "n.observation = a.observation GROUP BY n.term, a.object",
    "object"};
// The index holds 32 bits: times that need more are the first or the last second that it has
// (stay_seconds()).
constexpr DerivedTable kStay = {
    "stay", "belief, x_from, x_to, y_from, y_to, z_from, z_to, since, until, place_from, place_to, object",
    "SELECT id AS belief, x, x, y, y, z, z, min(max(valid_from / 1000000000, -2147483647), 2147483646), "
    "until, "
    "place, place, object FROM (SELECT id, object, valid_from, iif(status = 'gone', -1, 1) * coalesce(place, "
    "0) "
    "AS place, round(min(max(1000 * x, -2e9), 2e9)) AS x, round(min(max(1000 * y, -2e9), 2e9)) AS y, "
    "round(min(max(1000 * z, -2e9), 2e9)) AS z, coalesce(min(max(lead(valid_from) OVER (PARTITION BY object "
    "ORDER BY valid_from, id) / 1000000000, -2147483647), 2147483646), 2147483647) AS until FROM belief "
    "WHERE {known}{filter}) WHERE "
    "x IS NOT NULL AND y IS NOT NULL AND z IS NOT NULL",
    "belief"};
constexpr std::array kDerivedTables = {kSceneRank, kObservationRank, kVisit, kObjectTerm, kStay};

/// Tables whose rows are counted.
constexpr std::array kCountedTables = {
    "scene",  "observation", "annotation",        "blob",      "association", "event",
    "belief", "visibility",  "feature_structure", "scene_log", "reasoning",   "stay"};

std::string select_text(const DerivedTable& table, const char* filter = "") {
  return fmt::format(fmt::runtime(table.select), fmt::arg("observed", kObserved), fmt::arg("step", kRankStep),
                     fmt::arg("filter", filter), fmt::arg("known", kKnownBelief));
}

/// Derives the rows of one object.
void derive_for_object(Store::Connection& db, const DerivedTable& table, Id object) {
  db.run(fmt::format("DELETE FROM {} WHERE object = ?1", table.name), {sql(object)});
  db.run(fmt::format("INSERT INTO {} ({}) {}", table.name, table.columns,
                     select_text(table, " AND object = ?1")),
         {sql(object)});
}

}  // namespace

int64_t stay_seconds(TimeNs time) {
  return std::clamp<int64_t>(time / kSecond, -kOpenStay, kOpenStay - 1);
}

void derive_tables(SQLite::Database& database) {
  for (const DerivedTable& table : kDerivedTables)
    database.exec(fmt::format("DELETE FROM {0}; INSERT INTO {0} ({1}) {2}", table.name, table.columns,
                              select_text(table)));
  database.exec("INSERT INTO term_text (term_text) VALUES ('rebuild')");
  count_rows(database);
}

void derive_tables_of(SQLite::Database& database, const std::set<Id>& observed, const std::set<Id>& believed,
                      std::map<std::string, int64_t> added) {
  run_statements(database, fmt::format("DELETE FROM {0}; INSERT INTO {0} ({1}) {2};", kSceneRank.name,
                                       kSceneRank.columns, select_text(kSceneRank)));
  const auto derive = [&](const DerivedTable& table, Id object, const char* condition) {
    const int64_t removed = run_statements(
        database, fmt::format("DELETE FROM {} WHERE {};", table.name, condition), {sql(object)});
    return run_statements(database,
                          fmt::format("INSERT INTO {} ({}) {};", table.name, table.columns,
                                      select_text(table, " AND object = ?1")),
                          {sql(object)}) -
           removed;
  };
  for (const Id object : observed)
    for (const DerivedTable& table : {kObservationRank, kVisit, kObjectTerm})
      derive(table, object, "object = ?1");
  for (const Id object : believed)  // stays have no index of objects
    added[kStay.name] += derive(kStay, object, "belief IN (SELECT id FROM main.belief WHERE object = ?1)");
  for (const char* table : kCountedTables)
    if (added.contains(table))
      run_statements(database, "UPDATE row_count SET rows = rows + ?1 WHERE name = ?2;",
                     {sql(added.at(table)), std::string_view(table)});
}

void count_rows(SQLite::Database& database) {
  database.exec("DELETE FROM row_count");
  for (const char* table : kCountedTables)
    database.exec(fmt::format("INSERT INTO row_count (name, rows) SELECT '{0}', count(*) FROM {0}", table));
  derive_digests(database);
}

std::vector<std::string> derived_problems(Store::Connection& db) {
  std::vector<std::string> problems;
  for (const DerivedTable& table : kDerivedTables) {
    const std::string query = fmt::format(
        "WITH derived ({0}) AS ({1}) SELECT DISTINCT {2} FROM (SELECT * FROM (SELECT {0} FROM {3} EXCEPT "
        "SELECT {0} "
        "FROM derived) UNION ALL SELECT * FROM (SELECT {0} FROM derived EXCEPT SELECT {0} FROM {3}))",
        table.columns, select_text(table), table.subject, table.name);
    for (const Id id : db.values<Id>(query))
      problems.push_back(fmt::format("table {} does not agree with the other tables about {} {}", table.name,
                                     table.subject, id));
  }
  for (const char* table : kCountedTables) {
    const int64_t counted =
        db.value<int64_t>("SELECT rows FROM row_count WHERE name = ?", {std::string_view(table)}).value_or(0);
    const int64_t found = query_integer(*db.database, fmt::format("SELECT count(*) FROM {}", table));
    if (found != counted)
      problems.push_back(fmt::format("{} has {} rows, not the {} counted", table, found, counted));
  }
  if (db.value<int64_t>("SELECT count(*) FROM row_count").value_or(0) > int64_t{kCountedTables.size()})
    problems.push_back("table row_count counts what is no table");
  return problems;
}

void Store::Connection::add_stay(Id belief, const BeliefRow& row, TimeNs from) {
  const int64_t since = stay_seconds(from);
  const auto before = value<Id>(
      fmt::format("SELECT id FROM belief WHERE object = ?1 AND valid_from <= ?2 AND id <> ?3 AND {} ORDER BY "
                  "valid_from DESC, id DESC LIMIT 1",
                  kKnownBelief),
      {sql(row.object), sql(from), sql(belief)});
  if (before) run("UPDATE stay SET until = ?1 WHERE belief = ?2 AND until > ?1", {sql(since), sql(*before)});
  if (!row.position) return;
  const auto next = value<TimeNs>(
      fmt::format(
          "SELECT valid_from FROM belief WHERE object = ?1 AND valid_from >= ?2 AND (valid_from, id) > "
          "(?2, ?3) AND {} ORDER BY valid_from, id LIMIT 1",
          kKnownBelief),
      {sql(row.object), sql(from), sql(belief)});
  const int64_t until = next ? stay_seconds(*next) : kOpenStay;
  const auto millimetres = [&](int axis) {  // rounded as SQLite does
    const double value = std::clamp((*row.position)[axis] * 1000, -2e9, 2e9);
    return sql(static_cast<int64_t>(value + (value < 0 ? -0.5 : 0.5)));
  };
  const SqlValue x = millimetres(0), y = millimetres(1), z = millimetres(2),
                 place = sql((row.status == ObjectStatus::gone ? -1 : 1) * row.place.value_or(0));
  ++added["stay"];
  run("INSERT INTO stay VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      {sql(belief), x, x, y, y, z, z, sql(since), sql(until), place, place, sql(row.object)});
}

void Store::Connection::add_object_term(Id object, Id term, TimeNs time) {
  constexpr size_t kMaxCached = 20000;
  if (object_terms.size() > kMaxCached) object_terms.clear();
  const auto [known, is_new] = object_terms.try_emplace({object, term}, time);
  if (!is_new && known->second <= time) return;
  known->second = time;
  run("INSERT INTO object_term (term, object, since) VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET since = "
      "excluded.since WHERE excluded.since < since",
      {sql(term), sql(object), sql(time)});
}

void Store::Connection::rank_scene(Id scene, TimeNs time) {
  const std::pair<TimeNs, Id> key{time, scene};
  if (scenes) {
    ++scenes->count;
  } else {  // this one included
    scenes = Sequence();
    scenes->count = *value<int64_t>("SELECT count(*) FROM scene");
    query("SELECT time, id FROM scene ORDER BY time DESC, id DESC LIMIT 1", {}, [&](const SqlRow& row) {
      scenes->last = {row.get<TimeNs>("time"), row.get<Id>("id")};
    });
  }
  if (key < scenes->last) {  // the ranks of those after it have changed
    run("DELETE FROM scene_rank", {});
    run(fmt::format("INSERT INTO scene_rank ({}) {}", kSceneRank.columns, select_text(kSceneRank)), {});
    return;
  }
  scenes->last = key;
  if (scenes->count % kRankStep == 1)
    run("INSERT INTO scene_rank (number, time, scene) VALUES (?, ?, ?)",
        {sql(scenes->count), sql(time), sql(scene)});
}

void Store::Connection::rank_observation(Id object, Id observation, TimeNs time, Id scene) {
  const std::pair<TimeNs, Id> key{time, scene};
  const auto added_now = new_observations.find(observation);
  const Id place =
      added_now != new_observations.end()
          ? added_now->second.place
          : value<Id>("SELECT coalesce(place, 0) FROM observation WHERE id = ?", {sql(observation)})
                .value_or(0);
  const auto [slot, unknown] = observations.try_emplace(object);
  Sequence& sequence = slot->second;
  const bool may_be_again = unknown || sequence.last == key;
  const auto read_last_place = [&] {
    sequence.place =
        value<Id>("SELECT place FROM visit WHERE object = ? ORDER BY valid_from DESC, scene DESC LIMIT 1",
                  {sql(object)});
  };
  if (unknown) {  // this one included
    const std::string of_object = fmt::format(" FROM association WHERE object = ? AND {}", kObserved);
    sequence.count = *value<int64_t>("SELECT count(*)" + of_object, {sql(object)});
    query("SELECT valid_from, scene" + of_object + " ORDER BY valid_from DESC, scene DESC LIMIT 1",
          {sql(object)}, [&](const SqlRow& row) {
            sequence.last = {row.get<TimeNs>("valid_from"), row.get<Id>("scene")};
          });
    read_last_place();
  } else {
    ++sequence.count;
  }
  if (key < sequence.last) {  // the ranks and visits after it have changed
    derive_for_object(*this, kObservationRank, object);
    derive_for_object(*this, kVisit, object);
    read_last_place();
    return;
  }
  sequence.last = key;
  if (sequence.count % kRankStep == 1)
    run("INSERT INTO observation_rank (object, number, valid_from, scene) VALUES (?, ?, ?, ?)",
        {sql(object), sql(sequence.count), sql(time), sql(scene)});
  if (sequence.place == place) return;
  if (may_be_again) {  // taken for another observation of the scene than before
    derive_for_object(*this, kVisit, object);
    read_last_place();
    return;
  }
  run("INSERT INTO visit (object, place, valid_from, scene) VALUES (?, ?, ?, ?)",
      {sql(object), sql(place), sql(time), sql(scene)});
  sequence.place = place;
}

void Store::Connection::save_counts() {
  for (const char* table : kCountedTables)
    if (const auto found = added.find(table); found != added.end())
      run("INSERT INTO row_count (name, rows) VALUES (?, ?) ON CONFLICT DO UPDATE SET rows = rows + "
          "excluded.rows",
          {std::string_view(table), sql(found->second)});
  add_to_digests(*this, digests);
  digests.clear();
  added.clear();
  new_observations.clear();
}

void Store::Connection::clear_caches() {
  digests.clear();
  added.clear();
  new_observations.clear();
  object_terms.clear();
  terms.clear();
  scenes.reset();
  observations.clear();
}

void Store::derive() {
  auto& db = *connection_;
  db.require_writable();
  db.clear_caches();
  db.transaction([&] { derive_tables(*db.database); });
}

}  // namespace loci::memory
