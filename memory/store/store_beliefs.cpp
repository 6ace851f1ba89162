// What is believed as of a time: the last row of news, carried on to the last scene (see `belief` in the
// schema).

#include <algorithm>
#include <cmath>

#include "memory/store/reading.h"

namespace loci::memory {
namespace {

constexpr const char* kSighting = "chosen = 1 AND observation IS NOT NULL AND probability > 0";

}  // namespace

bool asks_what_was_known(Store::Implementation& store, const AsOf& as_of) {
  bool superseded = as_of.known_at.has_value();
  store.query("SELECT 1 FROM association WHERE supersedes IS NOT NULL LIMIT 1", {},
              [&](const SqlRow&) { superseded = true; });
  return superseded;
}

namespace {

/// Sightings of ?1, with the clocks. Where nothing was ever superseded, no row need be looked up.
std::string sightings_of_object(Store::Implementation& store, const AsOf& as_of,
                                std::vector<SqlValue>& values) {
  const bool superseded = asks_what_was_known(store, as_of);
  std::string text = fmt::format(" FROM {} WHERE object = ?1 AND {}",
                                 superseded ? "association_known" : "association", kSighting);
  if (superseded) text += " AND " + known_condition(as_of, values);
  return text + range_condition("valid_from", {}, as_of.at, values);
}

/// The last scene that is asked about, of which no more is needed.
struct Latest {
  Id id = 0;
  TimeNs time = 0;
};

std::optional<Latest> latest_of(Store::Implementation& store, const AsOf& as_of) {
  std::vector<SqlValue> values;
  const std::string range = range_condition("time", {}, as_of.at, values) +
                            range_condition("known_from", {}, as_of.known_at, values);
  std::optional<Latest> latest;
  store.query("SELECT id, time FROM scene WHERE 1" + range + " ORDER BY time DESC, id DESC LIMIT 1", values,
              [&](const SqlRow& row) {
                latest = {row.integer("id"), row.integer("time")};
              });
  return latest;
}

/// Carries rows on to the last scene that is asked about.
class Carrier {
 public:
  Carrier(Store::Implementation& store, const AsOf& as_of)
      : store_(store), latest_(latest_of(store, as_of)), as_of_(as_of) {}

  void carry_on(BeliefRow& row) {
    if (!latest_) return;
    const bool seen_later = read_last_sighting(row);
    if (row.status == ObjectStatus::gone && !seen_later) return;
    if (seen_later) {
      row.probability_then = 1;
      row.then = sighting_time_;
      row.status = ObjectStatus::seen;
    }
    row.probability = faded(row, latest_->time);
    if (row.last_scene == latest_->id)
      row.status = ObjectStatus::seen;
    else if (seen_later || row.scene != latest_->id)
      row.status = unseen_status(row.object);
  }

 private:
  /// Whether the object was seen after the row.
  bool read_last_sighting(BeliefRow& row) {
    std::vector<SqlValue> values = {sql(row.object)};
    const std::string text = "SELECT scene, observation, valid_from" +
                             sightings_of_object(store_, as_of_, values) +
                             " ORDER BY valid_from DESC, scene DESC LIMIT 1";
    bool later = false;
    store_.query(text, values, [&](const SqlRow& found) {
      sighting_time_ = found.integer("valid_from");
      if (sighting_time_ < row.clock.valid_from) return;
      later = sighting_time_ > row.clock.valid_from;
      row.last_scene = found.integer("scene");
      row.last_observation = found.integer("observation");
    });
    return later;
  }

  ObjectStatus unseen_status(Id object) {
    ObjectStatus status = ObjectStatus::out_of_view;
    store_.query("SELECT status FROM visibility WHERE scene = ? AND object = ? AND status <> 'seen'",
                 {sql(latest_->id), sql(object)},
                 [&](const SqlRow& found) { status = found.state<ObjectStatus>("status"); });
    return status;
  }

  Store::Implementation& store_;
  std::optional<Latest> latest_;
  AsOf as_of_;
  TimeNs sighting_time_ = 0;
};

std::optional<BeliefRow> last_row(Store::Implementation& store, Id object, const AsOf& as_of) {
  std::vector<SqlValue> values = {sql(object)};
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, false);
  auto rows = all<BeliefRow>(store,
                             fmt::format("SELECT * FROM belief_known WHERE object = ?1 AND {} AND {} ORDER "
                                         "BY valid_from DESC, id DESC LIMIT 1",
                                         known, valid),
                             values, belief_row);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

bool has_stays(const Store::Implementation& store) {
  return store.version >= 1001;
}
bool has_marks(const Store::Implementation& store) {
  return store.version >= 1002;
}
bool has_scene_marks(const Store::Implementation& store) {
  return store.version >= 1003;
}

/// How many scenes there are up to a time: from the last mark on only the few after it are counted.
int64_t scenes_until(Store::Implementation& store, std::optional<TimeNs> time) {
  std::vector<SqlValue> values;
  const std::string until = range_condition("time", {}, time, values);
  int64_t count = 0;
  std::string after;
  std::vector<SqlValue> rest = values;
  store.query("SELECT number, time, scene FROM scene_mark WHERE 1" + until +
                  " ORDER BY time DESC, number DESC LIMIT 1",
              values, [&](const SqlRow& row) {
                count = row.integer("number");
                rest.push_back(sql(row.integer("time")));
                rest.push_back(sql(row.integer("scene")));
                after = fmt::format(" AND (time, id) > (?{}, ?{})", values.size() + 1, values.size() + 2);
              });
  store.query("SELECT count(*) AS number FROM scene WHERE 1" + until + after, rest,
              [&](const SqlRow& row) { count += row.integer("number"); });
  return count;
}

/// Of rows of belief, those that are of gone objects, the last first.
Store::Gone gone_of(const std::vector<BeliefRow>& rows, Id place, size_t most) {
  std::vector<std::pair<TimeNs, Id>> gone;
  for (const BeliefRow& row : rows)
    if (row.place == place && row.status == ObjectStatus::gone)
      gone.emplace_back(-row.clock.valid_from, row.object);
  std::ranges::sort(gone);
  Store::Gone result{.in_all = gone.size()};
  for (const auto& [time, object] : gone)
    if (result.objects.size() < most) result.objects.push_back(object);
  return result;
}

/// From the last mark on only the few sightings after it are counted.
Store::ObservationCount count_from_mark(Store::Implementation& store, Id object, const AsOf& as_of) {
  Store::ObservationCount result;
  std::vector<SqlValue> values = {sql(object)};
  const std::string until = range_condition("valid_from", {}, as_of.at, values);
  const std::string marks = "SELECT number, valid_from, scene FROM sighting_mark WHERE object = ?1" + until;
  std::vector<SqlValue> after = values;
  store.query(marks + " ORDER BY number DESC LIMIT 1", values, [&](const SqlRow& row) {
    result.count = static_cast<size_t>(row.integer("number"));
    after.push_back(sql(row.integer("valid_from")));
    after.push_back(sql(row.integer("scene")));
  });
  if (result.count == 0) return result;
  store.query(fmt::format("SELECT count(*) AS number FROM association WHERE object = ?1 AND {}{} AND "
                          "(valid_from, scene) > (?{}, ?{})",
                          kSighting, until, values.size() + 1, values.size() + 2),
              after, [&](const SqlRow& row) { result.count += static_cast<size_t>(row.integer("number")); });
  store.query("SELECT scene FROM sighting_mark WHERE object = ? AND number = 1", {sql(object)},
              [&](const SqlRow& row) { result.first_scene = row.integer("scene"); });
  return result;
}

}  // namespace

double faded(const BeliefRow& row, TimeNs time) {
  if (!row.fade_s || !row.fade_to || time <= row.then) return row.probability_then;
  const double seconds = static_cast<double>(time - row.then) / static_cast<double>(kSecond);
  return row.probability_then * (*row.fade_to + (1 - *row.fade_to) * std::exp(-seconds / *row.fade_s));
}

std::vector<BeliefRow> Store::beliefs(const AsOf& as_of) const {
  std::vector<BeliefRow> result;
  implementation_->guarded([&] {
    Carrier carrier(*implementation_, as_of);
    for (const ObjectRow& object : objects(as_of)) {
      std::optional<BeliefRow> row = last_row(*implementation_, object.id, as_of);
      if (!row) continue;
      carrier.carry_on(*row);
      result.push_back(std::move(*row));
    }
  });
  return result;
}

std::optional<BeliefRow> Store::belief(Id object, const AsOf& as_of) const {
  return implementation_->guarded([&] {
    std::optional<BeliefRow> row = last_row(*implementation_, object, as_of);
    if (row) Carrier(*implementation_, as_of).carry_on(*row);
    return row;
  });
}

std::vector<Id> Store::objects_at(Id place, const AsOf& as_of) const {
  if (!has_stays(*implementation_) || as_of.known_at) {
    std::vector<Id> result;
    for (const BeliefRow& row : beliefs(as_of))
      if (row.place == place) result.push_back(row.object);
    return result;
  }
  const int64_t time = as_of.at ? *as_of.at / kSecond : kOpenStay;
  return all<Id>(
      *implementation_,
      "SELECT DISTINCT object FROM stay WHERE place_from <= ?1 AND place_to >= ?1 AND since <= ?2 AND "
      "until >= ?2 ORDER BY object",
      {sql(place), sql(time)}, [](const SqlRow& row) { return row.integer("object"); });
}

Store::Gone Store::objects_gone_from(Id place, size_t most, const AsOf& as_of) const {
  if (!has_scene_marks(*implementation_) || as_of.known_at) return gone_of(beliefs(as_of), place, most);
  const int64_t time = as_of.at ? *as_of.at / kSecond : kOpenStay;
  Gone result;
  for (const Id object :
       all<Id>(*implementation_,
               "SELECT object FROM stay WHERE place_from <= ?1 AND place_to >= ?1 AND since <= ?2 "
               "AND until >= ?2 ORDER BY since DESC, belief DESC",
               {sql(-place), sql(time)}, [](const SqlRow& row) { return row.integer("object"); })) {
    ++result.in_all;
    if (result.objects.size() < most) result.objects.push_back(object);
  }
  return result;
}

std::vector<Id> Store::objects_near(const Vector3d& point, double radius, const AsOf& as_of) const {
  std::vector<Id> found;
  if (!has_stays(*implementation_) || as_of.known_at) {
    for (const ObjectRow& row : objects(as_of)) found.push_back(row.id);
  } else {
    const int64_t time = as_of.at ? *as_of.at / kSecond : kOpenStay;
    std::vector<SqlValue> values = {sql(time)};
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-radius, radius})
        values.push_back(sql(static_cast<int64_t>(
            std::lround(std::clamp(1000 * (point[axis] + side), -2e9, 2e9)) + (side < 0 ? -1 : 1))));
    found = all<Id>(
        *implementation_,
        "SELECT DISTINCT object FROM stay WHERE since <= ?1 AND until >= ?1 AND x_to >= ?2 AND x_from <= ?3 "
        "AND y_to >= ?4 AND y_from <= ?5 AND z_to >= ?6 AND z_from <= ?7 ORDER BY object",
        values, [](const SqlRow& row) { return row.integer("object"); });
  }
  std::erase_if(found, [&](Id object) {
    const std::optional<BeliefRow> row = belief(object, as_of);
    return !row || !row->position || (*row->position - point).norm() > radius;
  });
  return found;
}

Store::ObservationCount Store::count_observations(Id object, const AsOf& as_of) const {
  ObservationCount result;
  implementation_->guarded([&] {
    if (has_marks(*implementation_) && !asks_what_was_known(*implementation_, as_of)) {
      result = count_from_mark(*implementation_, object, as_of);
      return;
    }
    std::vector<SqlValue> values = {sql(object)};
    const std::string rows = sightings_of_object(*implementation_, as_of, values);
    implementation_->query("SELECT count(*) AS number" + rows, values, [&](const SqlRow& row) {
      result.count = static_cast<size_t>(row.integer("number"));
    });
    implementation_->query("SELECT scene" + rows + " ORDER BY valid_from, scene LIMIT 1", values,
                           [&](const SqlRow& row) { result.first_scene = row.integer("scene"); });
  });
  return result;
}

Store::VisibilityCounts Store::visibility_since(Id object, TimeNs after, std::optional<TimeNs> until,
                                                const AsOf& as_of) const {
  VisibilityCounts result;
  if (as_of.at && (!until || *as_of.at < *until)) until = as_of.at;
  implementation_->guarded([&] {
    int64_t scenes = 0;
    if (as_of.known_at || !has_scene_marks(*implementation_)) {
      std::vector<SqlValue> values = {sql(after)};
      const std::string range = range_condition("time", {}, until, values) +
                                range_condition("known_from", {}, as_of.known_at, values);
      implementation_->query("SELECT count(*) AS number FROM scene WHERE time > ?1" + range, values,
                             [&](const SqlRow& row) { scenes = row.integer("number"); });
    } else {
      scenes = scenes_until(*implementation_, until) - scenes_until(*implementation_, after);
    }
    std::vector<SqlValue> values = {sql(object), sql(after)};
    const std::string range = range_condition("valid_from", {}, until, values) +
                              range_condition("known_from", {}, as_of.known_at, values);
    implementation_->query(
        "SELECT status, count(*) AS number, scene, max(valid_from) FROM visibility WHERE object = ?1 AND "
        "status IN "
        "('hidden', 'missed') AND valid_from > ?2" +
            range + " GROUP BY status",
        values, [&](const SqlRow& row) {
          const auto number = static_cast<size_t>(row.integer("number"));
          const bool missed = row.state<ObjectStatus>("status") == ObjectStatus::missed;
          (missed ? result.missed : result.hidden) = number;
          if (missed) result.last_missed = row.integer("scene");
          scenes -= row.integer("number");
        });
    result.out_of_view = static_cast<size_t>(std::max<int64_t>(0, scenes));
  });
  return result;
}

namespace {

/// Of objects that were called so, those of which a sighting that is known shows it.
std::vector<Id> objects_called(Store::Implementation& store, const std::string& terms,
                               const std::string& word, const AsOf& as_of) {
  std::vector<SqlValue> values = {sql(word)};
  if (has_marks(store) && !asks_what_was_known(store, as_of)) {
    const std::string begun = range_condition("since", {}, as_of.at, values);
    return all<Id>(store,
                   fmt::format("SELECT DISTINCT object FROM object_term WHERE term IN ({}){} ORDER BY object",
                               terms, begun),
                   values, [](const SqlRow& row) { return row.integer("object"); });
  }
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, false);
  if (!has_stays(store))
    return all<Id>(
        store,
        fmt::format("SELECT DISTINCT object FROM association_known WHERE chosen = 1 AND probability > 0 AND "
                    "object IS NOT NULL AND {} AND {} AND observation IN (SELECT observation FROM annotation "
                    "WHERE value = ?1 COLLATE NOCASE) ORDER BY object",
                    known, valid),
        values, [](const SqlRow& row) { return row.integer("object"); });
  return all<Id>(
      store,
      fmt::format("SELECT DISTINCT t.object AS object FROM object_term t WHERE t.term IN ({}) AND EXISTS ("
                  "SELECT 1 FROM association_known a JOIN annotation n ON n.scene = a.scene AND "
                  "n.observation = a.observation WHERE a.object = t.object AND n.term = t.term AND "
                  "a.chosen = 1 AND a.observation IS NOT NULL AND a.probability > 0 AND {} AND {}) "
                  "ORDER BY object",
                  terms, known, valid),
      values, [](const SqlRow& row) { return row.integer("object"); });
}

}  // namespace

std::vector<Id> Store::objects_annotated(const std::string& value, const AsOf& as_of) const {
  return objects_called(*implementation_, "SELECT id FROM term WHERE value = ?1 COLLATE NOCASE", value,
                        as_of);
}

std::vector<Id> Store::objects_with_text(const std::string& words, const AsOf& as_of) const {
  if (!has_stays(*implementation_)) return {};
  std::string match;  // each word quoted: nothing in it is an operator
  for (const char c : words) match += c == '"' ? "\"\"" : c == ' ' ? "\" \"" : std::string(1, c);
  return objects_called(*implementation_, "SELECT rowid FROM term_text WHERE term_text MATCH ?1",
                        "\"" + match + "\"", as_of);
}

std::vector<std::string> Store::annotation_values() const {
  const char* text =
      has_stays(*implementation_)
          ? "SELECT DISTINCT value FROM term WHERE id IN (SELECT term FROM object_term) ORDER BY value"
          : "SELECT DISTINCT value FROM annotation WHERE observation IS NOT NULL ORDER BY value";
  return all<std::string>(*implementation_, text, {}, [](const SqlRow& row) { return row.text("value"); });
}

}  // namespace loci::memory
