// What remains of what was forgotten: a tombstone, which merges with other copies honour.

#include <random>
#include <tuple>

#include "mapping/base/text/hash.h"
#include "memory/store/erasure/erased_images.h"
#include "memory/store/erasure/erasure.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {
namespace {

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

struct Tombstone {
  Id id = 0;
  std::string salt = {};
  std::optional<TimeNs> from = {}, to = {};
  TimeNs known_from = 0;
  std::set<std::string> signatures = {};
};

Tombstone tombstone_of(const Targets& targets, const std::vector<std::string>& identities, TimeNs known) {
  std::random_device random;
  const uint64_t high = random(), low = random();
  Tombstone made{.id = static_cast<Id>((high << 31 ^ low) & 0x3fffffffffffffff) + 1,
                 .salt = unguessable_hex(8),
                 .known_from = known};
  if (targets.interval) std::tie(made.from, made.to) = *targets.interval;
  for (const std::string& identity : identities) made.signatures.insert(signature(made.salt, identity));
  return made;
}

std::vector<Tombstone> read_tombstones(Store::Connection& db) {
  std::vector<Tombstone> tombstones;
  db.query("SELECT * FROM forgotten ORDER BY known_from, id", {}, [&](const SqlRow& row) {
    tombstones.push_back({row.get<Id>("id"), row.get<std::string>("salt"),
                          row.get<std::optional<TimeNs>>("valid_from"),
                          row.get<std::optional<TimeNs>>("valid_to"), row.get<TimeNs>("known_from")});
  });
  for (Tombstone& one : tombstones)
    for (std::string& keyed : db.values<std::string>(
             "SELECT signature FROM forgotten_signature WHERE forgotten = ?", {sql(one.id)}))
      one.signatures.insert(std::move(keyed));
  return tombstones;
}

void insert(Store::Connection& db, const Tombstone& one, Id run) {
  db.run("INSERT INTO forgotten (id, salt, valid_from, valid_to, known_from, run) VALUES (?, ?, ?, ?, ?, ?)",
         {sql(one.id), sql(one.salt), sql(one.from), sql(one.to), sql(one.known_from), sql(run)});
  for (const std::string& keyed : one.signatures)
    db.run("INSERT INTO forgotten_signature (forgotten, signature) VALUES (?, ?)", {sql(one.id), sql(keyed)});
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

void Eraser::read_signatures() {
  if (targets_.interval) return;
  db_.query(fmt::format("{} WHERE {} ORDER BY o.id", kObservationIdentity, is_gone("o.id", "observation")),
            {}, [&](const SqlRow& row) { identities_.push_back(observation_identity(row)); });
  db_.query(fmt::format("{} WHERE {} ORDER BY f.id", kFactIdentity, is_gone("f.id", "fact")), {},
            [&](const SqlRow& row) { identities_.push_back(row.get<std::string>("identity")); });
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
    throw error("the first time is after the second", "give the earlier one first");
  return erasing(db, [&] {
    Eraser eraser(*this, db, targets, run);
    ForgetResult result = eraser.erase(filter);
    insert(db, tombstone_of(targets, eraser.identities(), db.known_time()), run);
    return result;
  });
}

void Store::replace_forgotten(Id run) {
  auto& db = *connection_;
  db.require_writable();
  erasing(db, [&] {
    const std::set<Id> emptied = Eraser(*this, db, {}, run).replace_superseded();
    if (!emptied.empty()) Eraser(*this, db, {.objects = emptied}, run).erase({});
    return true;
  });
}

void Store::add_tombstones(const Store& other, Id run) {
  connection_->require_writable();
  const std::vector<Tombstone> tombstones =
      other.connection_->guarded([&] { return read_tombstones(*other.connection_); });
  ChangeTransaction all(*this);
  connection_->guarded([&] {
    for (const Tombstone& one : tombstones) insert(*connection_, one, run);
  });
  all.commit();
}

ForgetResult Store::honour_tombstones(const Store& younger) {
  Connection &db = *connection_, &other = *younger.connection_;
  const std::vector<Tombstone> tombstones = read_tombstones(other);
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
      targets = targets_of(db, tombstone.salt, tombstone.signatures, common_scenes);
      if (targets.observations.empty() && targets.facts.empty()) continue;
    }
    if (!run) run = begin_run("loci-memory merge", "{}");
    const ForgetResult erased = erasing(db, [&] {
      ForgetResult one = Eraser(*this, db, targets, *run).erase({});
      // The belief has it too; it begins anew from the rows.
      run_statements(*db.database,
                     "DELETE FROM checkpoint WHERE name LIKE 'belief%' OR name LIKE 'before/%';");
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
