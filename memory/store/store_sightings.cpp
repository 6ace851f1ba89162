// What was seen of objects, and what happened to them.

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "memory/store/reading.h"

namespace loci::memory {

namespace {

/// As the view object_known, which looks through all objects for each of them.
constexpr const char* kObjectsKnown =
    "SELECT a.id, a.valid_from, a.valid_to, a.known_from, coalesce(a.known_to, later.since) AS known_to, "
    "a.supersedes, a.run, a.source FROM object a LEFT JOIN (SELECT supersedes AS id, min(known_from) AS "
    "since "
    "FROM object WHERE supersedes IS NOT NULL GROUP BY supersedes) later ON later.id = a.id";

}  // namespace

std::vector<ObjectRow> Store::objects(const AsOf& as_of) const {
  std::vector<SqlValue> values;
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, false);
  return all<ObjectRow>(
      *implementation_,
      fmt::format("SELECT * FROM ({}) WHERE {} AND {} ORDER BY id", kObjectsKnown, known, valid), values,
      [](const SqlRow& row) {
        return ObjectRow{row.integer("id"), row.clock()};
      });
}

std::vector<BeliefRow> Store::belief_history(Id object, const AsOf& as_of,
                                             std::optional<TimeNs> since) const {
  std::vector<SqlValue> values = {sql(object)};
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, false);
  std::string rows = fmt::format("FROM belief_known WHERE object = ?1 AND {} AND {}", known, valid);
  if (since) {
    values.push_back(sql(*since));
    rows += fmt::format(
        " AND valid_from >= coalesce((SELECT valid_from {0} AND valid_from <= ?{1} ORDER BY valid_from DESC "
        "LIMIT 1), ?{1})",
        rows, values.size());
  }
  return all<BeliefRow>(*implementation_, "SELECT * " + rows + " ORDER BY valid_from, id", values,
                        belief_row);
}

namespace {

/// Sightings of ?1 that fulfil a condition, in an order.
std::vector<ObjectObservation> sightings_where(Store::Implementation& store, const std::string& condition,
                                               const std::string& order,
                                               const std::vector<SqlValue>& values) {
  const std::string chosen = fmt::format(
      "SELECT * FROM association_known WHERE object = ?1 AND chosen = 1 AND observation IS NOT NULL AND "
      "probability > 0 AND {} ORDER BY {}",
      condition, order);
  std::vector<ObjectObservation> result;
  for (AssociationRow& association : all<AssociationRow>(store, chosen, values, association_row))
    result.push_back({std::move(association)});
  // The same rows in the same order, seen from their observations.
  SQLite::Statement& seen = store.statement(
      "SELECT o.*, s.time AS scene_time, s.recording AS scene_recording, s.frame_index AS scene_frame FROM "
      "observation o JOIN scene s ON s.id = o.scene WHERE o.id = ?");
  store.guarded([&] {
    for (ObjectObservation& sighting : result) {
      seen.reset();
      bind_values(seen, {sql(sighting.association.observation)});
      if (!seen.executeStep()) continue;
      const SqlRow row(seen);
      sighting.observation = observation_row(row);
      sighting.time = row.integer("scene_time");
      sighting.recording = row.optional_integer("scene_recording");
      sighting.frame_index = row.optional_integer("scene_frame");
    }
    seen.reset();
  });
  return result;
}

/// " AND" that its observation lies on one of the places.
std::string on_places(const std::vector<Id>& places) {
  if (places.empty()) return {};
  return fmt::format(" AND EXISTS (SELECT 1 FROM observation o WHERE o.id = observation AND o.place IN ({}))",
                     fmt::join(places, ", "));
}

}  // namespace

std::vector<ObjectObservation> Store::observations_of(Id object, const AsOf& as_of,
                                                      std::optional<TimeNs> from,
                                                      std::optional<TimeNs> to) const {
  std::vector<SqlValue> values = {sql(object)};
  std::string condition = known_condition(as_of, values);
  condition +=
      " AND " + valid_condition(as_of, values, false) + range_condition("valid_from", from, to, values);
  return sightings_where(*implementation_, condition, "valid_from, id", values);
}

namespace {

/// When an object was on a place, by the order of its sightings (time, scene): from one on, until before
/// another.
struct Visit {
  Id place = 0;
  TimeNs from = 0;
  Id scene = 0;
};

std::optional<Visit> visit_where(Store::Implementation& store, const std::string& condition,
                                 const std::vector<SqlValue>& values) {
  const auto rows =
      all<Visit>(store, "SELECT place, valid_from, scene FROM visit WHERE object = ?1 AND " + condition,
                 values, [](const SqlRow& row) {
                   return Visit{row.integer("place"), row.integer("valid_from"), row.integer("scene")};
                 });
  return rows.empty() ? std::nullopt : std::optional(rows[0]);
}

std::optional<Visit> visit_after(Store::Implementation& store, Id object, const Visit& visit) {
  return visit_where(store, "(valid_from, scene) > (?2, ?3) ORDER BY valid_from, scene LIMIT 1",
                     {sql(object), sql(visit.from), sql(visit.scene)});
}

std::optional<ObjectObservation> first_of(std::vector<ObjectObservation> rows) {
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

/// The last sighting on a place before a time.
std::optional<ObjectObservation> last_on_place(Store::Implementation& store, Id object, Id place,
                                               TimeNs time) {
  const auto visit =
      visit_where(store, "place = ?2 AND valid_from < ?3 ORDER BY valid_from DESC, scene DESC LIMIT 1",
                  {sql(object), sql(place), sql(time)});
  if (!visit) return std::nullopt;
  std::vector<SqlValue> values = {sql(object), sql(time)};
  std::string condition = "valid_from < ?2";
  if (const auto next = visit_after(store, object, *visit)) {
    values.insert(values.end(), {sql(next->from), sql(next->scene)});
    condition += " AND (valid_from, scene) < (?3, ?4)";
  }
  return first_of(sightings_where(store, condition, "valid_from DESC, scene DESC LIMIT 1", values));
}

/// The first sighting on a place after a time.
std::optional<ObjectObservation> first_on_place(Store::Implementation& store, Id object, Id place,
                                                TimeNs time) {
  const auto during = visit_where(store, "valid_from <= ?2 ORDER BY valid_from DESC, scene DESC LIMIT 1",
                                  {sql(object), sql(time)});
  if (during && during->place == place) {
    std::vector<SqlValue> values = {sql(object), sql(time)};
    std::string condition = "valid_from > ?2";
    if (const auto next = visit_after(store, object, *during)) {
      values.insert(values.end(), {sql(next->from), sql(next->scene)});
      condition += " AND (valid_from, scene) < (?3, ?4)";
    }
    if (auto found = first_of(sightings_where(store, condition, "valid_from, scene LIMIT 1", values)))
      return found;
  }
  const auto next = visit_where(store, "place = ?2 AND valid_from > ?3 ORDER BY valid_from, scene LIMIT 1",
                                {sql(object), sql(place), sql(time)});
  if (!next) return std::nullopt;
  return first_of(sightings_where(store, "valid_from = ?2 AND scene = ?3", "id LIMIT 1",
                                  {sql(object), sql(next->from), sql(next->scene)}));
}

/// Whether `visit` tells where the object was seen, as of these clocks.
bool has_visits(Store::Implementation& store, const AsOf& as_of) {
  return store.version >= 1003 && store.guarded([&] { return !asks_what_was_known(store, as_of); });
}

}  // namespace

std::optional<ObjectObservation> Store::last_observation_before(Id object, TimeNs time,
                                                                const std::vector<Id>& places,
                                                                const AsOf& as_of) const {
  if (as_of.at) time = std::min(time, *as_of.at + 1);
  if (!places.empty() && has_visits(*implementation_, as_of)) {
    std::optional<ObjectObservation> last;
    for (const Id place : places) {
      auto one = last_on_place(*implementation_, object, place, time);
      if (one && (!last || one->time > last->time)) last = std::move(one);
    }
    return last;
  }
  std::vector<SqlValue> values = {sql(object), sql(time)};
  const std::string condition = "valid_from < ?2 AND " + known_condition(as_of, values) + on_places(places);
  return first_of(
      sightings_where(*implementation_, condition, "valid_from DESC, scene DESC LIMIT 1", values));
}

std::optional<ObjectObservation> Store::first_observation_after(Id object, TimeNs time,
                                                                const std::vector<Id>& places,
                                                                const AsOf& as_of) const {
  if (!places.empty() && has_visits(*implementation_, as_of)) {
    std::optional<ObjectObservation> first;
    for (const Id place : places) {
      auto one = first_on_place(*implementation_, object, place, time);
      if (one && (!as_of.at || one->time <= *as_of.at) && (!first || one->time < first->time))
        first = std::move(one);
    }
    return first;
  }
  std::vector<SqlValue> values = {sql(object), sql(time)};
  std::string condition = "valid_from > ?2 AND " + known_condition(as_of, values);
  condition += " AND " + valid_condition(as_of, values, false) + on_places(places);
  return first_of(sightings_where(*implementation_, condition, "valid_from, scene LIMIT 1", values));
}

std::vector<ObjectObservation> Store::alternative_observations(Id object, TimeNs from, const AsOf& as_of,
                                                               double least, size_t scenes) const {
  std::vector<SqlValue> values = {sql(object), sql(from), sql(as_of.at.value_or(INT64_MAX)),
                                  sql(static_cast<int64_t>(scenes))};
  const std::string known = known_condition(as_of, values);
  const auto rows = all<AssociationRow>(
      *implementation_,
      fmt::format(
          "SELECT * FROM association_known WHERE scene IN (SELECT id FROM scene WHERE time >= ?2 AND "
          "time <= ?3 ORDER BY time DESC LIMIT ?4) AND object = ?1 AND observation IS NOT NULL AND {} "
          "ORDER BY id",
          known),
      values, association_row);
  std::map<Id, AssociationRow> doubtful;  // by observation, its explanations together
  for (const AssociationRow& row : rows) {
    const auto [entry, fresh] = doubtful.try_emplace(*row.observation, row);
    if (fresh) continue;
    entry->second.probability += row.probability;
    entry->second.chosen = entry->second.chosen || row.chosen;
  }
  std::vector<ObjectObservation> result;
  for (auto& [observation, association] : doubtful) {
    if (association.chosen || association.probability < least) continue;
    const SceneRow seen_in = scene(association.scene);
    ObjectObservation sighting{
        std::move(association), {}, seen_in.time, seen_in.recording, seen_in.frame_index};
    for (ObservationRow& row : observations(seen_in.id))
      if (row.id == observation) sighting.observation = std::move(row);
    result.push_back(std::move(sighting));
  }
  std::stable_sort(result.begin(), result.end(), [](const ObjectObservation& a, const ObjectObservation& b) {
    return a.association.probability > b.association.probability;
  });
  return result;
}

std::vector<AssociationRow> Store::associations(Id scene, const AsOf& as_of) const {
  std::vector<SqlValue> values = {sql(scene)};
  const std::string known = known_condition(as_of, values);
  return all<AssociationRow>(
      *implementation_,
      fmt::format("SELECT * FROM association_known WHERE scene = ?1 AND {} ORDER BY id", known), values,
      association_row);
}

std::vector<EventRow> Store::events(const AsOf& as_of, std::optional<TimeNs> from,
                                    std::optional<TimeNs> to) const {
  std::vector<SqlValue> values;
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, false);
  const std::string range = range_condition("valid_from", from, to, values);
  return all<EventRow>(
      *implementation_,
      fmt::format("SELECT * FROM event_known WHERE probability > 0 AND {} AND {}{} ORDER BY valid_from, id",
                  known, valid, range),
      values, event_row);
}

}  // namespace loci::memory
