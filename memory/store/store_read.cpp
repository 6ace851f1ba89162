#include <charconv>

#include "memory/store/reading.h"

namespace loci::memory {

Store::ReadTransaction::ReadTransaction(const Store& store) : store_(*store.implementation_) {
  if (store_.writable || store_.moments++ > 0) return;
  try {
    store_.guarded([&] { store_.database->exec("BEGIN"); });
  } catch (...) {
    --store_.moments;
    throw;
  }
}

Store::ReadTransaction::~ReadTransaction() {
  if (store_.writable || --store_.moments > 0) return;
  for (auto& [text, statement] : store_.statements) statement->tryReset();
  store_.database->tryExec("COMMIT");
}

std::optional<std::string> Store::meta(const std::string& key) const {
  const auto rows = all<std::string>(*implementation_, "SELECT value FROM meta WHERE key = ?", {sql(key)},
                                     [](const SqlRow& row) { return row.text("value"); });
  return rows.empty() ? std::nullopt : std::optional(rows[0]);
}

int Store::time_zone_minutes() const {
  const auto text = meta("time_zone_minutes");
  int minutes = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), minutes);
  return minutes;
}

std::vector<RunRow> Store::runs() const {
  return all<RunRow>(*implementation_, "SELECT * FROM run ORDER BY id", {}, [](const SqlRow& row) {
    return RunRow{row.integer("id"),         row.text("program"),    row.text("version"),
                  row.text("configuration"), row.integer("started"), row.optional_integer("finished")};
  });
}

std::vector<RecordingRow> Store::recordings() const {
  return all<RecordingRow>(*implementation_, "SELECT * FROM recording ORDER BY id", {}, recording_row);
}

std::optional<RecordingRow> Store::recording(const std::string& fingerprint) const {
  const auto rows = all<RecordingRow>(*implementation_, "SELECT * FROM recording WHERE fingerprint = ?",
                                      {sql(fingerprint)}, recording_row);
  return rows.empty() ? std::nullopt : std::optional(rows[0]);
}

std::set<int64_t> Store::frames(Id recording) const {
  const auto rows = all<int64_t>(
      *implementation_, "SELECT frame_index FROM scene WHERE recording = ? AND frame_index IS NOT NULL",
      {sql(recording)}, [](const SqlRow& row) { return row.integer("frame_index"); });
  return {rows.begin(), rows.end()};
}

std::vector<MapRow> Store::maps() const {
  return all<MapRow>(*implementation_, "SELECT * FROM map ORDER BY id", {}, [](const SqlRow& row) {
    return MapRow{row.integer("id"), row.text("hash"), row.text("name"), row.integer("urdf"),
                  row.optional_integer("sidecar")};
  });
}

std::vector<PlaceRow> Store::places() const {
  return all<PlaceRow>(*implementation_, "SELECT * FROM place ORDER BY id", {}, place_row);
}

std::vector<SceneRow> Store::scenes(const AsOf& as_of, std::optional<TimeNs> from,
                                    std::optional<TimeNs> to) const {
  std::vector<SqlValue> values;
  std::string text = "SELECT * FROM scene WHERE 1" + range_condition("time", from, to, values) +
                     range_condition("time", {}, as_of.at, values) +
                     range_condition("known_from", {}, as_of.known_at, values);
  return all<SceneRow>(*implementation_, text + " ORDER BY time, id", values, scene_row);
}

SceneRow Store::scene(Id id) const {
  return one<SceneRow>(*implementation_, "scene", id, scene_row);
}

std::optional<SceneRow> Store::last_scene() const {
  auto rows = all<SceneRow>(*implementation_, "SELECT * FROM scene ORDER BY id DESC LIMIT 1", {}, scene_row);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

std::optional<SceneRow> Store::latest_scene(const AsOf& as_of) const {
  std::vector<SqlValue> values;
  const std::string range = range_condition("time", {}, as_of.at, values) +
                            range_condition("known_from", {}, as_of.known_at, values);
  auto rows = all<SceneRow>(*implementation_,
                            "SELECT * FROM scene WHERE 1" + range + " ORDER BY time DESC, id DESC LIMIT 1",
                            values, scene_row);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

std::optional<TimeNs> Store::last_scene_time() const {
  const auto rows = all<TimeNs>(*implementation_, "SELECT time FROM scene ORDER BY time DESC LIMIT 1", {},
                                [](const SqlRow& row) { return row.integer("time"); });
  return rows.empty() ? std::nullopt : std::optional(rows[0]);
}

std::vector<ObservationRow> Store::observations(Id scene) const {
  return all<ObservationRow>(*implementation_, "SELECT * FROM observation WHERE scene = ? ORDER BY number",
                             {sql(scene)}, observation_row);
}

ObservationRow Store::observation(Id id) const {
  return one<ObservationRow>(*implementation_, "observation", id, observation_row);
}

Id Store::max_observation_id() const {
  return all<Id>(*implementation_, "SELECT coalesce(max(id), 0) AS id FROM observation", {},
                 [](const SqlRow& row) { return row.integer("id"); })
      .front();
}

Id Store::max_object_id() const {
  return all<Id>(*implementation_, "SELECT coalesce(max(id), 0) AS id FROM object", {},
                 [](const SqlRow& row) { return row.integer("id"); })
      .front();
}

std::vector<AnnotationRow> Store::annotations(Id scene) const {
  return all<AnnotationRow>(*implementation_, "SELECT * FROM annotation_said WHERE scene = ? ORDER BY id",
                            {sql(scene)}, [](const SqlRow& row) {
                              return AnnotationRow{row.integer("id"),
                                                   row.integer("scene"),
                                                   row.optional_integer("observation"),
                                                   row.text("type"),
                                                   row.text("value"),
                                                   row.optional_real("confidence"),
                                                   row.optional_integer("feature_structure")};
                            });
}

std::vector<LogRow> Store::log(Id scene) const {
  return all<LogRow>(*implementation_, "SELECT * FROM scene_log WHERE scene = ? ORDER BY number",
                     {sql(scene)}, [](const SqlRow& row) {
                       return LogRow{row.integer("scene"),
                                     row.integer("number"),
                                     row.text("annotator"),
                                     row.text("level"),
                                     row.optional_text("text").value_or(std::string()),
                                     row.optional_real("milliseconds")};
                     });
}

std::vector<VisibilityRow> Store::visibility(Id scene) const {
  return all<VisibilityRow>(*implementation_, "SELECT * FROM visibility WHERE scene = ? ORDER BY id",
                            {sql(scene)}, visibility_row);
}

namespace {

std::vector<VisibilityRow> visibility_of(Store::Implementation& store, const char* what, Id id,
                                         std::optional<TimeNs> from, std::optional<TimeNs> to) {
  std::vector<SqlValue> values = {sql(id)};
  const std::string range = range_condition("valid_from", from, to, values);
  return all<VisibilityRow>(
      store, fmt::format("SELECT * FROM visibility WHERE {} = ?1{} ORDER BY valid_from, id", what, range),
      values, visibility_row);
}

}  // namespace

std::vector<VisibilityRow> Store::visibility_of_object(Id object, std::optional<TimeNs> from,
                                                       std::optional<TimeNs> to) const {
  return visibility_of(*implementation_, "object", object, from, to);
}

std::vector<VisibilityRow> Store::visibility_of_place(Id place, std::optional<TimeNs> from,
                                                      std::optional<TimeNs> to) const {
  return visibility_of(*implementation_, "place", place, from, to);
}

std::optional<VisibilityRow> Store::last_visibility(Id place, const AsOf& as_of) const {
  std::vector<SqlValue> values = {sql(place)};
  const std::string range = range_condition("valid_from", {}, as_of.at, values) +
                            range_condition("known_from", {}, as_of.known_at, values);
  auto rows = all<VisibilityRow>(*implementation_,
                                 "SELECT * FROM visibility WHERE place = ?1 AND fraction > 0" + range +
                                     " ORDER BY valid_from DESC, scene DESC LIMIT 1",
                                 values, visibility_row);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

std::vector<FactRow> Store::facts(const AsOf& as_of) const {
  std::vector<SqlValue> values;
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, true);
  return all<FactRow>(
      *implementation_,
      fmt::format("SELECT * FROM fact_known WHERE value IS NOT NULL AND {} AND {} ORDER BY id", known, valid),
      values, fact_row);
}

}  // namespace loci::memory
