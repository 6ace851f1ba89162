// Objects and what is believed of them as of a time: the last stored row, extrapolated to that time (see
// `belief` in the schema).

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/row_columns.h"

namespace loci::memory {
namespace {

/// As the view object_known, which searches all objects for each of them.
constexpr const char* kObjectsKnown =
    "(SELECT a.id, a.valid_from, a.valid_to, a.known_from, coalesce(a.known_to, later.since) AS known_to, "
    "a.supersedes, a.run, a.source FROM object a LEFT JOIN (SELECT supersedes AS id, min(known_from) AS "
    "since FROM "
    "object WHERE supersedes IS NOT NULL GROUP BY supersedes) later ON later.id = a.id)";

/// The latest scene as of a time, and no more of it than is needed.
struct LatestScene {
  Id id = 0;
  TimeNs time = 0;
};

std::optional<LatestScene> latest_scene_of(Store::Connection& db, const AsOf& as_of) {
  const Where where = Where().added("time", as_of);
  std::optional<LatestScene> latest;
  db.query(
      fmt::format("SELECT id, time FROM scene WHERE {} ORDER BY time DESC, id DESC LIMIT 1", where.text()),
      where.values(), [&](const SqlRow& row) {
        latest = {row.get<Id>("id"), row.get<TimeNs>("time")};
      });
  return latest;
}

/// A time may be given to the minute: so long a scene stands for it.
constexpr TimeNs kSceneHolds = kMinute;

/// Extrapolates stored rows to the time asked about, else to the latest scene.
class Extrapolation {
 public:
  Extrapolation(Store::Connection& db, const AsOf& as_of)
      : db_(db), latest_(latest_scene_of(db, as_of)), as_of_(as_of) {
    if (!latest_) return;
    time_ = std::max(latest_->time, as_of.at.value_or(latest_->time));
    is_seen_now_ = time_ - latest_->time < kSceneHolds;
  }

  void apply(BeliefRow& row) {
    if (!latest_) return;
    const bool seen_later = read_last_observation(row);
    if (row.status == ObjectStatus::gone && !seen_later) return;
    if (seen_later) {
      row.probability_then = 1;
      row.then = observed_at_;
      row.status = ObjectStatus::seen;
    }
    row.probability = faded(row, time_);
    if (row.last_scene == latest_->id)
      row.status = is_seen_now_ ? ObjectStatus::seen : ObjectStatus::out_of_view;
    else if (seen_later || row.scene != latest_->id)
      row.status = unseen_status(row.object);
  }

 private:
  /// Whether the object was observed after the row.
  bool read_last_observation(BeliefRow& row) {
    // Where nothing was ever superseded, no row need be looked up.
    const bool known = !db_.needs_known(as_of_);
    Where where(fmt::format("object = ?1 AND {}", kObserved), {sql(row.object)});
    if (!known) where.known(as_of_);
    where.begun(as_of_);
    bool later = false;
    db_.query(
        fmt::format(
            "SELECT scene, observation, valid_from FROM {} WHERE {} ORDER BY valid_from DESC, scene DESC "
            "LIMIT 1",
            known ? "association" : "association_known", where.text()),
        where.values(), [&](const SqlRow& found) {
          observed_at_ = found.get<TimeNs>("valid_from");
          if (observed_at_ < row.clock.valid_from) return;
          later = observed_at_ > row.clock.valid_from;
          row.last_scene = found.get<Id>("scene");
          row.last_observation = found.get<Id>("observation");
        });
    return later;
  }

  ObjectStatus unseen_status(Id object) {
    return db_
        .value<ObjectStatus>(
            "SELECT status FROM visibility WHERE scene = ? AND object = ? AND status <> 'seen' "
            "ORDER BY id DESC LIMIT 1",
            {sql(latest_->id), sql(object)})
        .value_or(ObjectStatus::out_of_view);
  }

  Store::Connection& db_;
  std::optional<LatestScene> latest_;
  AsOf as_of_;
  TimeNs time_ = 0;           ///< that is asked about
  bool is_seen_now_ = false;  ///< whether the latest scene is of that time
  TimeNs observed_at_ = 0;
};

std::optional<BeliefRow> last_row(Store::Connection& db, Id object, const AsOf& as_of) {
  return select_first<BeliefRow>(db, "belief_known",
                                 Where("object = ?1", {sql(object)}).known(as_of).begun(as_of),
                                 "valid_from DESC, id DESC");
}

/// The time of a stay that is asked about.
int64_t stay_time(const AsOf& as_of) {
  return as_of.at ? stay_seconds(*as_of.at) : kOpenStay;
}

/// A stay at the time asked about.
struct Stay {
  Id belief = 0;
  int64_t since = 0;
  bool surely = false;  ///< it neither begins nor ends within the second asked about
};

/// Objects with a stay of this code of a place (negative = gone from it) at a time, the latest first. Stays
/// have whole seconds: what begins or ends within the one asked about is looked up. The objects are read of
/// `max_count` of them only.
Store::Gone objects_staying(Store::Connection& db, Id code, size_t max_count, const AsOf& as_of) {
  std::vector<Stay> stays;
  db.query(
      "SELECT belief, since, since < ?2 AND until > ?2 AS surely FROM stay WHERE place_from <= ?1 AND "
      "place_to >= ?1 AND since <= ?2 AND until >= ?2",
      {sql(code), sql(stay_time(as_of))}, [&](const SqlRow& row) {
        stays.push_back({row.get<Id>("belief"), row.get<int64_t>("since"), row.get<bool>("surely")});
      });
  std::ranges::sort(stays, std::greater(),
                    [](const Stay& stay) { return std::pair(stay.since, stay.belief); });
  Store::Gone found;
  std::set<Id> looked_up;
  for (const Stay& stay : stays) {
    const bool sure = stay.surely || !as_of.at;
    if (sure && found.objects.size() >= max_count) {
      ++found.in_all;
      continue;
    }
    const Id object = *db.value<Id>("SELECT object FROM belief WHERE id = ?", {sql(stay.belief)});
    if (!sure) {
      if (!looked_up.insert(object).second) continue;
      const std::optional<BeliefRow> row = last_row(db, object, as_of);
      if (!row || row->place != std::abs(code) || (row->status == ObjectStatus::gone) != (code < 0)) continue;
    }
    ++found.in_all;
    if (found.objects.size() < max_count) found.objects.push_back(object);
  }
  return found;
}

/// Objects of which an observation has one of the terms that the query `terms` finds for ?1.
std::vector<Id> objects_with_terms(Store::Connection& db, const std::string& terms, const SqlValues& values,
                                   const AsOf& as_of) {
  Where where("1", values);
  const bool has_label =
      db.value<int64_t>(
            fmt::format("SELECT 1 FROM term WHERE type = '{}' AND id IN ({}) LIMIT 1", kLabelType, terms),
            values)
          .has_value();
  if (!has_label && !db.needs_known(as_of)) {
    where.between("since", {}, as_of.at);
    return db.values<Id>(
        fmt::format("SELECT DISTINCT object FROM object_term WHERE term IN ({}) AND {} ORDER BY object",
                    terms, where.text()),
        where.values());
  }
  where.known(as_of).begun(as_of);
  if (has_label) where.and_also(where.label_holds(as_of));
  return db.values<Id>(
      fmt::format(
          "SELECT DISTINCT t.object FROM object_term t WHERE t.term IN ({}) AND EXISTS (SELECT 1 FROM "
          "association_known a JOIN annotation n ON n.scene = a.scene AND n.observation = a.observation "
          "WHERE "
          "a.object = t.object AND n.term = t.term AND a.chosen = 1 AND a.observation IS NOT NULL AND "
          "a.probability > 0 AND {}) ORDER BY t.object",
          terms, where.text()),
      where.values());
}

}  // namespace

Vector3d turned_as(Vector3d extents, const Vector3d& other) {
  if ((extents.x() > extents.y()) != (other.x() > other.y())) std::swap(extents.x(), extents.y());
  return extents;
}

double faded(const BeliefRow& row, TimeNs time) {
  if (!row.fade_s || !row.fade_to || time <= row.then) return row.probability_then;
  const double seconds = in_seconds(time - row.then);
  return row.probability_then * (*row.fade_to + (1 - *row.fade_to) * std::exp(-seconds / *row.fade_s));
}

std::vector<ObjectRow> Store::objects(const AsOf& as_of) const {
  return select<ObjectRow>(*connection_, kObjectsKnown, Where().known(as_of).begun(as_of));
}

std::vector<BeliefRow> Store::beliefs(const AsOf& as_of) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::vector<BeliefRow> result;
    Extrapolation extrapolation(db, as_of);
    for (const ObjectRow& object : objects(as_of)) {
      std::optional<BeliefRow> row = last_row(db, object.id, as_of);
      if (!row) continue;
      extrapolation.apply(*row);
      result.push_back(std::move(*row));
    }
    return result;
  });
}

std::optional<BeliefRow> Store::belief(Id object, const AsOf& as_of) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::optional<BeliefRow> row = last_row(db, object, as_of);
    if (row) Extrapolation(db, as_of).apply(*row);
    return row;
  });
}

std::vector<BeliefRow> Store::belief_history(Id object, const AsOf& as_of,
                                             std::optional<TimeNs> since) const {
  Where where("object = ?1", {sql(object)});
  where.known(as_of).begun(as_of);
  if (since) {
    const std::string time = where.bind(sql(*since));
    where.and_also(
        fmt::format("valid_from >= coalesce((SELECT valid_from FROM belief_known WHERE {0} AND valid_from "
                    "<= {1} ORDER BY valid_from DESC LIMIT 1), {1})",
                    where.text(), time));
  }
  return select<BeliefRow>(*connection_, "belief_known", where, "valid_from, id");
}

std::vector<Id> Store::objects_at(Id place, const AsOf& as_of) const {
  if (as_of.known_at) {
    std::vector<Id> result;
    for (const BeliefRow& row : beliefs(as_of))
      if (row.place == place) result.push_back(row.object);
    return result;
  }
  return connection_->guarded([&] {
    std::vector<Id> there =
        objects_staying(*connection_, place, std::numeric_limits<size_t>::max(), as_of).objects;
    std::ranges::sort(there);
    return there;
  });
}

std::vector<Id> Store::present_candidates(const AsOf& as_of) const {
  if (as_of.known_at) {
    std::vector<Id> all;
    for (const ObjectRow& row : objects(as_of)) all.push_back(row.id);
    return all;
  }
  return connection_->values<Id>(
      "SELECT object FROM stay WHERE since <= ?1 AND until >= ?1 AND place_to >= 0 UNION SELECT object FROM "
      "belief WHERE x IS NULL ORDER BY object",
      {sql(stay_time(as_of))});
}

Store::Gone Store::objects_gone_from(Id place, size_t max_count, const AsOf& as_of) const {
  if (!as_of.known_at)
    return connection_->guarded([&] { return objects_staying(*connection_, -place, max_count, as_of); });
  std::vector<std::pair<TimeNs, Id>> gone;
  for (const BeliefRow& row : beliefs(as_of))
    if (row.place == place && row.status == ObjectStatus::gone)
      gone.emplace_back(-row.clock.valid_from, row.object);
  std::ranges::sort(gone);
  Gone result{.in_all = gone.size()};
  gone.resize(std::min(gone.size(), max_count));
  for (const auto& [time, object] : gone) result.objects.push_back(object);
  return result;
}

std::vector<Id> Store::objects_near(const Vector3d& point, double radius, const AsOf& as_of) const {
  auto& db = *connection_;
  const auto is_near = [&](const Vector3d& position) { return (position - point).norm() <= radius; };
  std::set<Id> found, to_look_up;
  SqlValues values = {sql(stay_time(as_of))};
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-radius, radius})
      values.push_back(sql(static_cast<int64_t>(
          std::lround(std::clamp(1000 * (point[axis] + side), -2e9, 2e9)) + (side < 0 ? -1 : 1))));
  return db.guarded([&] {
    if (as_of.known_at)
      for (const ObjectRow& row : objects(as_of)) to_look_up.insert(row.id);
    else
      db.query(
          "SELECT s.object, s.since < ?1 AND s.until > ?1 AS surely, b.x, b.y, b.z FROM stay s CROSS JOIN "
          "belief b ON b.id = s.belief WHERE s.since <= ?1 AND s.until >= ?1 AND s.x_to >= ?2 AND s.x_from "
          "<= ?3 AND s.y_to >= ?4 AND s.y_from <= ?5 AND s.z_to >= ?6 AND s.z_from <= ?7",
          values, [&](const SqlRow& row) {
            const Id object = row.get<Id>("object");
            if (as_of.at && !row.get<bool>("surely"))
              to_look_up.insert(object);
            else if (is_near({row.get<double>("x"), row.get<double>("y"), row.get<double>("z")}))
              found.insert(object);
          });
    for (const Id object : to_look_up)
      if (const auto row = last_row(db, object, as_of); row && row->position && is_near(*row->position))
        found.insert(object);
    return std::vector<Id>(found.begin(), found.end());
  });
}

std::vector<Id> Store::objects_annotated(const std::string& value, const AsOf& as_of) const {
  return objects_with_terms(*connection_, "SELECT id FROM term WHERE value = ?1 COLLATE NOCASE", {sql(value)},
                            as_of);
}

std::vector<Id> Store::objects_annotated(const std::string& value, const std::string& type, bool of_type,
                                         const AsOf& as_of) const {
  return objects_with_terms(
      *connection_,
      fmt::format("SELECT id FROM term WHERE value = ?1 COLLATE NOCASE AND type {} ?2", of_type ? "=" : "<>"),
      {sql(value), sql(type)}, as_of);
}

std::vector<Id> Store::objects_with_text(const std::string& words, const AsOf& as_of) const {
  std::string match = "\"";  // each word quoted: nothing in it is an operator
  for (const char c : words) match += c == '"' ? "\"\"" : c == ' ' ? "\" \"" : std::string(1, c);
  match += '"';
  return objects_with_terms(*connection_, "SELECT rowid FROM term_text WHERE term_text MATCH ?1",
                            {sql(match)}, as_of);
}

std::vector<std::string> Store::annotation_values() const {
  return connection_->values<std::string>(
      "SELECT DISTINCT value FROM term WHERE id IN (SELECT term FROM object_term) ORDER BY value");
}

}  // namespace loci::memory
