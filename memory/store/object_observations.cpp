// Observations of an object by the MAP hypothesis.

#include <fmt/ranges.h>

#include <algorithm>

#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/row_columns.h"

namespace loci::memory {
namespace {

/// The observations among the rows of association that fulfil a condition, in an order.
std::vector<ObjectObservation> observations_where(Store::Connection& db, const Where& where,
                                                  const std::string& order) {
  std::vector<ObjectObservation> result;
  for (AssociationRow& association : select<AssociationRow>(db, "association_known", where, order))
    result.push_back({std::move(association)});
  db.guarded([&] {
    SQLite::Statement& observed = db.statement(
        "SELECT o.*, s.time AS scene_time, s.recording AS scene_recording, s.frame_index AS scene_frame FROM "
        "observation o JOIN scene s ON s.id = o.scene WHERE o.id = ?");
    for (ObjectObservation& one : result) {
      observed.reset();
      bind_values(observed, {sql(one.association.observation)});
      if (!observed.executeStep()) continue;
      const SqlRow row(observed);
      one.observation = read_row<ObservationRow>(row);
      one.time = row.get<TimeNs>("scene_time");
      one.recording = row.get<std::optional<Id>>("scene_recording");
      one.frame_index = row.get<std::optional<int64_t>>("scene_frame");
    }
    observed.reset();
  });
  return result;
}

std::optional<ObjectObservation> first_where(Store::Connection& db, const Where& where,
                                             const std::string& order) {
  auto rows = observations_where(db, where, order + " LIMIT 1");
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

Where observed(Id object) {
  return Where(fmt::format("object = ?1 AND {}", kObserved), {sql(object)});
}

void require_place(Where& where, const std::vector<Id>& places) {
  if (places.empty()) return;
  where.and_also(
      fmt::format("EXISTS (SELECT 1 FROM observation o WHERE o.id = observation AND o.place IN ({}))",
                  fmt::join(places, ", ")));
}

/// A row of table visit: the object is on the place from its observation at `from` in `scene` until its next
/// visit.
struct Visit {
  Id place = 0;
  TimeNs from = 0;
  Id scene = 0;
};

std::optional<Visit> visit_where(Store::Connection& db, const std::string& condition,
                                 const SqlValues& values) {
  return db.guarded([&] {
    std::optional<Visit> visit;
    db.query("SELECT place, valid_from, scene FROM visit WHERE object = ?1 AND " + condition + " LIMIT 1",
             values, [&](const SqlRow& row) {
               visit = {row.get<Id>("place"), row.get<TimeNs>("valid_from"), row.get<Id>("scene")};
             });
    return visit;
  });
}

/// Excludes observations after the end of a visit.
void require_before_end(Store::Connection& db, Id object, const Visit& visit, Where& where) {
  const auto next = visit_where(db, "(valid_from, scene) > (?2, ?3) ORDER BY valid_from, scene",
                                {sql(object), sql(visit.from), sql(visit.scene)});
  if (!next) return;
  const std::string from = where.bind(sql(next->from));
  where.and_also(fmt::format("(valid_from, scene) < ({}, {})", from, where.bind(sql(next->scene))));
}

std::optional<ObjectObservation> last_on_place(Store::Connection& db, Id object, Id place, TimeNs time) {
  const auto visit = visit_where(db, "place = ?2 AND valid_from < ?3 ORDER BY valid_from DESC, scene DESC",
                                 {sql(object), sql(place), sql(time)});
  if (!visit) return std::nullopt;
  Where where = observed(object);
  where.and_also("valid_from < " + where.bind(sql(time)));
  require_before_end(db, object, *visit, where);
  return first_where(db, where, "valid_from DESC, scene DESC");
}

std::optional<ObjectObservation> first_on_place(Store::Connection& db, Id object, Id place, TimeNs time) {
  const auto current =
      visit_where(db, "valid_from <= ?2 ORDER BY valid_from DESC, scene DESC", {sql(object), sql(time)});
  if (current && current->place == place) {
    Where where = observed(object);
    where.and_also("valid_from > " + where.bind(sql(time)));
    require_before_end(db, object, *current, where);
    if (auto found = first_where(db, where, "valid_from, scene")) return found;
  }
  const auto next = visit_where(db, "place = ?2 AND valid_from > ?3 ORDER BY valid_from, scene",
                                {sql(object), sql(place), sql(time)});
  if (!next) return std::nullopt;
  Where where = observed(object);
  where.and_also("valid_from = " + where.bind(sql(next->from)));
  where.and_also("scene = " + where.bind(sql(next->scene)));
  return first_where(db, where, "id");
}

/// Counts from the last ranked observation on.
Store::ObservationCount count_from_rank(Store::Connection& db, Id object, const AsOf& as_of) {
  Store::ObservationCount result;
  Where ranked("object = ?1", {sql(object)});
  ranked.begun(as_of);
  Where after = observed(object);
  after.begun(as_of);
  db.query(fmt::format(
               "SELECT number, valid_from, scene FROM observation_rank WHERE {} ORDER BY number DESC LIMIT 1",
               ranked.text()),
           ranked.values(), [&](const SqlRow& row) {
             result.count = row.get<size_t>("number");
             const std::string time = after.bind(sql(row.get<TimeNs>("valid_from")));
             after.and_also(
                 fmt::format("(valid_from, scene) > ({}, {})", time, after.bind(sql(row.get<Id>("scene")))));
           });
  if (result.count == 0) return result;
  result.count += *db.value<size_t>("SELECT count(*) FROM association WHERE " + after.text(), after.values());
  result.first_scene =
      db.value<Id>("SELECT scene FROM observation_rank WHERE object = ? AND number = 1", {sql(object)});
  return result;
}

/// How many scenes there are up to a time, counted from the last ranked one on.
int64_t scenes_until(Store::Connection& db, std::optional<TimeNs> time) {
  Where ranked, after;
  ranked.between("time", {}, time);
  after.between("time", {}, time);
  int64_t count = 0;
  db.query(fmt::format(
               "SELECT number, time, scene FROM scene_rank WHERE {} ORDER BY time DESC, number DESC LIMIT 1",
               ranked.text()),
           ranked.values(), [&](const SqlRow& row) {
             count = row.get<int64_t>("number");
             const std::string of = after.bind(sql(row.get<TimeNs>("time")));
             after.and_also(fmt::format("(time, id) > ({}, {})", of, after.bind(sql(row.get<Id>("scene")))));
           });
  return count + *db.value<int64_t>("SELECT count(*) FROM scene WHERE " + after.text(), after.values());
}

}  // namespace

std::vector<ObjectObservation> Store::observations_of(Id object, const AsOf& as_of,
                                                      std::optional<TimeNs> from,
                                                      std::optional<TimeNs> to) const {
  return observations_where(*connection_,
                            observed(object).known(as_of).begun(as_of).between("valid_from", from, to),
                            "valid_from, id");
}

Store::LatestObservations Store::latest_observations(Id object, size_t count,
                                                     const std::vector<std::string>& types,
                                                     const AsOf& as_of) const {
  auto& db = *connection_;
  return db.guarded([&] {
    LatestObservations latest;
    const bool known = !db.needs_known(as_of);
    Where where = observed(object);
    if (!known) where.known(as_of);
    where.begun(as_of);
    std::vector<std::string> of_types;
    for (const std::string& type : types) of_types.push_back(where.bind(sql(type)));
    Id counted = 0;
    db.query(fmt::format(
                 "SELECT s.run, l.id AS association, s.x - o.x AS x, s.y - o.y AS y, s.z - o.z AS z, "
                 "t.type, n.id, n.scene, n.observation, t.value, n.confidence, n.feature_structure FROM "
                 "(SELECT id, scene, observation FROM {} WHERE {} ORDER BY valid_from DESC, scene DESC "
                 "LIMIT {}) l CROSS JOIN scene s ON s.id = l.scene CROSS JOIN observation o ON o.id = "
                 "l.observation LEFT JOIN annotation n ON n.scene = l.scene AND n.observation = "
                 "l.observation LEFT JOIN term t ON t.id = n.term AND t.type IN ({})",
                 known ? "association" : "association_known", where.text(), count, fmt::join(of_types, ", ")),
             where.values(), [&](const SqlRow& row) {  // its columns in their order: that is fastest
               const Id run = row.get<Id>("run"), association = row.get<Id>("association");
               if (association != counted) ++latest.by_run[run];
               counted = association;
               const auto x = row.get<std::optional<double>>("x"), y = row.get<std::optional<double>>("y"),
                          z = row.get<std::optional<double>>("z");
               if (row.is_null("type")) return;
               std::optional<Vector3d> towards_camera;
               if (x && y && z) towards_camera = Vector3d(*x, *y, *z).normalized();
               latest.annotations.push_back({read_row<AnnotationRow>(row), run, towards_camera});
             });
    std::ranges::sort(latest.annotations, {}, [](const auto& one) { return one.row.id; });
    return latest;
  });
}

std::optional<Id> Store::object_instead_of(Id object) const {
  return connection_->value<Id>(
      fmt::format(
          "SELECT k.object FROM association a JOIN association_known k ON k.observation = "
          "a.observation WHERE a.object = ?1 AND a.chosen = 1 AND k.known_to IS NULL AND k.chosen = 1 "
          "AND k.probability > 0 AND k.object IS NOT NULL AND k.object <> ?1 AND NOT EXISTS (SELECT 1 "
          "FROM association_known o WHERE o.object = ?1 AND o.known_to IS NULL AND {}) GROUP BY "
          "k.object ORDER BY count(DISTINCT k.observation) DESC, k.object LIMIT 1",
          kObserved),
      {sql(object)});
}

std::optional<ObjectObservation> Store::last_observation_before(Id object, TimeNs time,
                                                                const std::vector<Id>& places,
                                                                const AsOf& as_of) const {
  auto& db = *connection_;
  if (as_of.at) time = std::min(time, *as_of.at + 1);
  if (!places.empty() && !db.needs_known(as_of)) {
    std::optional<ObjectObservation> last;
    for (const Id place : places) {
      auto one = last_on_place(db, object, place, time);
      if (one && (!last || one->time > last->time)) last = std::move(one);
    }
    return last;
  }
  Where where = observed(object);
  where.known(as_of).and_also("valid_from < " + where.bind(sql(time)));
  require_place(where, places);
  return first_where(db, where, "valid_from DESC, scene DESC");
}

std::optional<ObjectObservation> Store::first_observation_after(Id object, TimeNs time,
                                                                const std::vector<Id>& places,
                                                                const AsOf& as_of) const {
  auto& db = *connection_;
  if (!places.empty() && !db.needs_known(as_of)) {
    std::optional<ObjectObservation> first;
    for (const Id place : places) {
      auto one = first_on_place(db, object, place, time);
      if (one && (!as_of.at || one->time <= *as_of.at) && (!first || one->time < first->time))
        first = std::move(one);
    }
    return first;
  }
  Where where = observed(object);
  where.known(as_of).begun(as_of).and_also("valid_from > " + where.bind(sql(time)));
  require_place(where, places);
  return first_where(db, where, "valid_from, scene");
}

Store::ObservationCount Store::count_observations(Id object, const AsOf& as_of) const {
  auto& db = *connection_;
  return db.guarded([&]() -> ObservationCount {
    if (!db.needs_known(as_of)) return count_from_rank(db, object, as_of);
    const Where where = observed(object).known(as_of).begun(as_of);
    const std::string rows = " FROM association_known WHERE " + where.text();
    return {*db.value<size_t>("SELECT count(*)" + rows, where.values()),
            db.value<Id>("SELECT scene" + rows + " ORDER BY valid_from, scene LIMIT 1", where.values())};
  });
}

std::vector<ObjectObservation> Store::alternative_observations(Id object, TimeNs from, const AsOf& as_of,
                                                               double min_probability,
                                                               size_t max_scenes) const {
  Where where(
      "scene IN (SELECT id FROM scene WHERE time >= ?2 AND time <= ?3 ORDER BY time DESC LIMIT ?4) AND "
      "object = ?1 "
      "AND observation IS NOT NULL",
      {sql(object), sql(from), sql(as_of.at.value_or(INT64_MAX)), sql(static_cast<int64_t>(max_scenes))});
  std::map<Id, AssociationRow> alternatives;  // by observation, its explanations together
  for (const AssociationRow& row :
       select<AssociationRow>(*connection_, "association_known", where.known(as_of))) {
    const auto [entry, is_new] = alternatives.try_emplace(*row.observation, row);
    if (is_new) continue;
    entry->second.probability += row.probability;
    entry->second.chosen = entry->second.chosen || row.chosen;
  }
  std::vector<ObjectObservation> result;
  for (auto& [id, association] : alternatives) {
    if (association.chosen || association.probability < min_probability) continue;
    const SceneRow in = scene(association.scene);
    result.push_back({std::move(association), observation(id), in.time, in.recording, in.frame_index});
  }
  std::ranges::stable_sort(result, std::greater(),
                           [](const ObjectObservation& one) { return one.association.probability; });
  return result;
}

Store::VisibilityCounts Store::visibility_since(Id object, TimeNs after, std::optional<TimeNs> until,
                                                const AsOf& as_of) const {
  auto& db = *connection_;
  if (as_of.at && (!until || *as_of.at < *until)) until = as_of.at;
  return db.guarded([&] {
    VisibilityCounts result;
    int64_t scenes = 0;
    if (as_of.known_at) {
      Where where("time > ?1", {sql(after)});
      where.between("time", {}, until).between("known_from", {}, as_of.known_at);
      scenes = *db.value<int64_t>("SELECT count(*) FROM scene WHERE " + where.text(), where.values());
    } else {
      scenes = scenes_until(db, until) - scenes_until(db, after);
    }
    Where where("object = ?1 AND status IN ('hidden', 'missed') AND valid_from > ?2",
                {sql(object), sql(after)});
    where.between("valid_from", {}, until).between("known_from", {}, as_of.known_at);
    if (db.needs_known({})) where.newest_visibility(as_of);
    db.query(
        fmt::format(
            "SELECT status, count(*) AS number, scene, max(valid_from) FROM visibility WHERE {} GROUP BY "
            "status",
            where.text()),
        where.values(), [&](const SqlRow& row) {
          const bool missed = row.get<ObjectStatus>("status") == ObjectStatus::missed;
          (missed ? result.missed : result.hidden) = row.get<size_t>("number");
          if (missed) result.last_missed = row.get<Id>("scene");
          scenes -= row.get<int64_t>("number");
        });
    result.out_of_view = static_cast<size_t>(std::max<int64_t>(0, scenes));
    return result;
  });
}

}  // namespace loci::memory
