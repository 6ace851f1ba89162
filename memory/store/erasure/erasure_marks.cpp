// What is forgotten on request: which rows belong to it.

#include "mapping/base/text/json.h"
#include "memory/store/erasure/erasure.h"
#include "memory/store/rows/row_columns.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {

void Eraser::mark() {
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
  mark_abandoned_rows();
  for (const char* table : {"association", "event", "belief"}) retract_superseded(table);
  mark_superseded_facts();
  for (const Id id : db_.values<Id>("SELECT id FROM temp.gone_object")) result_.object_ids.insert(id);
  for (const Id id : db_.values<Id>("SELECT id FROM temp.gone_observation"))
    result_.observation_ids.insert(id);
  result_.objects = static_cast<int64_t>(result_.object_ids.size());
  result_.observations = static_cast<int64_t>(result_.observation_ids.size());
}

int64_t Eraser::mark_observations() {
  return change(
      "INSERT OR IGNORE INTO temp.gone_observation SELECT observation FROM association_known WHERE "
      "known_to IS NULL "
      "AND chosen = 1 AND probability > 0 AND observation IS NOT NULL AND object IN (SELECT id FROM "
      "temp.gone_object);");
}

int64_t Eraser::mark_emptied_objects() {
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

void Eraser::mark_rows() {
  const std::string object = is_gone("object", "object"), observation = is_gone("observation", "observation"),
                    scene = is_gone("scene", "scene");
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

void Eraser::mark_abandoned_rows() {
  const auto is_there = [](const char* prefix) {
    return fmt::format(
        "EXISTS (SELECT 1 FROM observation o WHERE o.x = r.{0}x AND o.y = r.{0}y AND o.id IN "
        "(SELECT id FROM temp.gone_observation))",
        prefix);
  };
  change(
      fmt::format("INSERT OR IGNORE INTO temp.gone_belief SELECT id FROM belief_known r WHERE r.known_to IS "
                  "NOT NULL AND {0};"
                  "INSERT OR IGNORE INTO temp.gone_event SELECT id FROM event_known r WHERE r.known_to IS "
                  "NOT NULL AND ({0} OR {1});"
                  "UPDATE event AS r SET from_place = NULL, from_x = NULL, from_y = NULL, from_z = NULL "
                  "WHERE id NOT IN (SELECT id FROM temp.gone_event) AND {1};",
                  is_there(""), is_there("from_")));
}

void Eraser::retract_superseded(const std::string& table) {
  const std::string gone = "(SELECT id FROM temp.gone_" + table + ")";
  const std::string instead =
      fmt::format("id IN {0} AND supersedes IS NOT NULL AND supersedes NOT IN {0}", gone);
  std::string columns;
  for (const std::string& column : db_.values<std::string>(fmt::format(
           "SELECT name FROM pragma_table_info('{}') WHERE name NOT IN ('id', 'supersedes', 'known_from', "
           "'known_to', 'run', 'source')",
           table)))
    columns += column + ", ";
  change(
      fmt::format("UPDATE {0} AS g SET ({1}known_to) = (SELECT {1}g.known_from FROM {0} t WHERE t.id = "
                  "g.supersedes) WHERE {2};"
                  "DELETE FROM temp.gone_{0} WHERE id IN (SELECT id FROM {0} WHERE {2});",
                  table, columns, instead));
  relink(table);
}

int64_t Eraser::relink(const std::string& table) {
  const std::string once = fmt::format(
      "UPDATE {0} SET supersedes = (SELECT g.supersedes FROM {0} g WHERE g.id = {0}.supersedes) WHERE id NOT "
      "IN {1} AND supersedes IN {1};",
      table, "(SELECT id FROM temp.gone_" + table + ")");
  int64_t all = 0;
  while (const int64_t changed = change(once)) all += changed;
  return all;
}

void Eraser::mark_superseded_facts() {
  const std::string gone = "(SELECT id FROM temp.gone_fact)";
  if (targets_.interval)  // until then it held
    change(fmt::format(
               "UPDATE fact SET valid_to = ?1 WHERE id NOT IN {0} AND valid_from < ?1 AND (valid_to IS NULL "
               "OR valid_to > ?1) AND id IN (SELECT supersedes FROM fact WHERE id IN {0});",
               gone),
           {sql(from())});
  const std::string follow = fmt::format(
      "INSERT OR IGNORE INTO temp.gone_fact SELECT t.id FROM fact t WHERE t.id NOT IN {0} AND t.id IN "
      "(SELECT "
      "supersedes FROM fact WHERE id IN {0}) AND NOT EXISTS (SELECT 1 FROM fact b WHERE b.supersedes = t.id "
      "AND b.id NOT IN {0}){1};",
      gone, targets_.interval ? fmt::format(" AND t.valid_from >= {}", from()) : "");
  do relink("fact");
  while (change(follow) > 0);
}

void Eraser::mark_runs() {
  std::map<Id, Json> edits;
  std::set<Id> gone;
  db_.query("SELECT * FROM run WHERE program LIKE 'loci-memory edit%' OR program LIKE 'loci-memory fact%'",
            {}, [&](const SqlRow& row) {
              const RunRow run = read_row<RunRow>(row);
              edits[run.id] = configuration_of(run, db_.path);
            });
  for (const Id run :
       db_.values<Id>(fmt::format("SELECT DISTINCT run FROM fact WHERE {}", is_gone("id", "fact"))))
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
  for (auto& [run, configuration] : edits) {
    if (gone.contains(run) || !configuration.contains("identity")) continue;
    for (Json& one : configuration["identity"])
      std::erase_if(one["observations"].get_ref<Json::array_t&>(), [&](const Json& observation) {
        return result_.observation_ids.contains(observation.get<Id>());
      });
    const std::string rest = configuration.dump();
    change("UPDATE run SET configuration = ?1 WHERE id = ?2;", {sql(rest), sql(run)});
  }
}

bool Eraser::mentions(const Json& configuration) const {
  const auto is = [](const Json& value, const std::set<Id>& ids) {
    return value.is_number_integer() && ids.contains(value.get<Id>());
  };
  if (configuration.contains("label") &&
      is(configuration["label"].value("observation", Json()), result_.observation_ids))
    return true;
  if (configuration.contains("identity"))
    for (const Json& one : configuration["identity"])
      if (is(one["object"], result_.object_ids) ||
          (targets_.interval && std::ranges::any_of(one["observations"], [&](const Json& observation) {
             return is(observation, result_.observation_ids);
           })))
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

}  // namespace loci::memory
