// What is derived while rows are added, so that questions need not count or walk through a history.

#include "memory/store/database.h"

namespace loci::memory {
namespace {

constexpr int64_t kRowsPerMark = 64;  // as in kDerivation

constexpr const char* kMarksOfScenes =
    "INSERT INTO scene_mark (number, time, scene) SELECT number, time, id FROM (SELECT id, time, "
    "row_number() OVER "
    "(ORDER BY time, id) AS number FROM scene) WHERE number % 64 = 1";
constexpr const char* kMarksOfObject =
    "INSERT INTO sighting_mark (object, number, valid_from, scene) SELECT object, number, valid_from, scene "
    "FROM (SELECT object, valid_from, scene, row_number() OVER (ORDER BY valid_from, scene) AS number FROM "
    "association WHERE object = ? AND chosen = 1 AND observation IS NOT NULL AND probability > 0) WHERE "
    "number % 64 = 1";
constexpr const char* kVisitsOfObject =
    "INSERT INTO visit (object, place, valid_from, scene) SELECT object, place, valid_from, scene FROM "
    "(SELECT "
    "a.object, coalesce(o.place, 0) AS place, a.valid_from, a.scene, lag(coalesce(o.place, 0)) OVER (ORDER "
    "BY "
    "a.valid_from, a.scene) AS place_before FROM association a JOIN observation o ON o.id = a.observation "
    "WHERE "
    "a.object = ? AND a.chosen = 1 AND a.probability > 0) WHERE place_before IS NOT place";

}  // namespace

void Store::Implementation::run(const char* text, const std::vector<SqlValue>& values) {
  SQLite::Statement& prepared = statement(text);
  bind_values(prepared, values);
  prepared.exec();
}

void Store::Implementation::forget_cached() {
  added.clear();
  just_seen.clear();
  called.clear();
  terms.clear();
  scenes.reset();
  sightings.clear();
}

void Store::Implementation::mark_scene(Id scene, TimeNs time) {
  const std::pair<TimeNs, Id> now{time, scene};
  if (!scenes) {  // with this one
    scenes = Seen();
    query("SELECT count(*) AS number FROM scene", {},
          [&](const SqlRow& row) { scenes->count = row.integer("number"); });
    query("SELECT time, id FROM scene ORDER BY time DESC, id DESC LIMIT 1", {}, [&](const SqlRow& row) {
      scenes->last = {row.integer("time"), row.integer("id")};
    });
  } else {
    ++scenes->count;
  }
  if (now < scenes->last) {  // those after it have other numbers now
    run("DELETE FROM scene_mark", {});
    run(kMarksOfScenes, {});
    return;
  }
  scenes->last = now;
  if (scenes->count % kRowsPerMark == 1)
    run("INSERT INTO scene_mark (number, time, scene) VALUES (?, ?, ?)",
        {sql(scenes->count), sql(time), sql(scene)});
}

void Store::Implementation::mark_sighting(Id object, Id observation, TimeNs time, Id scene) {
  const std::pair<TimeNs, Id> now{time, scene};
  Id place = 0;
  if (const auto now_seen = just_seen.find(observation); now_seen != just_seen.end())
    place = now_seen->second.place;
  else
    query("SELECT place FROM observation WHERE id = ?", {sql(observation)},
          [&](const SqlRow& row) { place = row.optional_integer("place").value_or(0); });
  const auto [slot, unknown] = sightings.try_emplace(object);
  Seen& seen = slot->second;
  const auto read_last_place = [&] {
    query("SELECT place FROM visit WHERE object = ? ORDER BY valid_from DESC, scene DESC LIMIT 1",
          {sql(object)}, [&](const SqlRow& row) { seen.place = row.integer("place"); });
  };
  if (unknown) {  // with this one
    query(
        "SELECT count(*) AS number FROM association WHERE object = ? AND chosen = 1 AND observation IS NOT "
        "NULL "
        "AND probability > 0",
        {sql(object)}, [&](const SqlRow& row) { seen.count = row.integer("number"); });
    query(
        "SELECT valid_from, scene FROM association WHERE object = ? AND chosen = 1 AND observation IS NOT "
        "NULL "
        "AND probability > 0 ORDER BY valid_from DESC, scene DESC LIMIT 1",
        {sql(object)}, [&](const SqlRow& row) {
          seen.last = {row.integer("valid_from"), row.integer("scene")};
        });
    read_last_place();
  } else {
    ++seen.count;
  }
  if (now < seen.last) {  // those after it have other numbers now
    run("DELETE FROM sighting_mark WHERE object = ?", {sql(object)});
    run(kMarksOfObject, {sql(object)});
    run("DELETE FROM visit WHERE object = ?", {sql(object)});
    run(kVisitsOfObject, {sql(object)});
    read_last_place();
    return;
  }
  seen.last = now;
  if (seen.count % kRowsPerMark == 1)
    run("INSERT INTO sighting_mark (object, number, valid_from, scene) VALUES (?, ?, ?, ?)",
        {sql(object), sql(seen.count), sql(time), sql(scene)});
  if (seen.place == place) return;
  run("INSERT INTO visit (object, place, valid_from, scene) VALUES (?, ?, ?, ?)",
      {sql(object), sql(place), sql(time), sql(scene)});
  seen.place = place;
}

}  // namespace loci::memory
