#include <fmt/ranges.h>

#include <charconv>

#include "mapping/base/json.h"
#include "memory/store/reading.h"

namespace loci {

std::string known_condition(const AsOf& as_of, std::vector<SqlValue>& values) {
  if (!as_of.known_at) return "known_to IS NULL";
  values.push_back(sql(*as_of.known_at));
  const size_t n = values.size();
  return fmt::format("known_from <= ?{0} AND (known_to IS NULL OR known_to > ?{0})", n);
}

std::string valid_condition(const AsOf& as_of, std::vector<SqlValue>& values, bool open) {
  if (!as_of.at) return open ? "valid_to IS NULL" : "1";
  values.push_back(sql(*as_of.at));
  const size_t n = values.size();
  return open ? fmt::format("valid_from <= ?{0} AND (valid_to IS NULL OR valid_to > ?{0})", n)
              : fmt::format("valid_from <= ?{}", n);
}

std::string range_condition(const char* column, std::optional<TimeNs> from, std::optional<TimeNs> to,
                            std::vector<SqlValue>& values) {
  std::string text;
  if (from) {
    values.push_back(sql(*from));
    text += fmt::format(" AND {} >= ?{}", column, values.size());
  }
  if (to) {
    values.push_back(sql(*to));
    text += fmt::format(" AND {} <= ?{}", column, values.size());
  }
  return text;
}

namespace {

RecordingRow recording_row(const SqlRow& row) {
  RecordingRow result;
  result.id = row.integer("id");
  result.fingerprint = row.text("fingerprint");
  result.name = row.text("name");
  result.kind = row.text("kind");
  result.time_assumed = row.integer("time_assumed") != 0;
  result.frames = row.optional_integer("frames");
  return result;
}

PlaceRow place_row(const SqlRow& row) {
  PlaceRow result;
  result.id = row.integer("id");
  result.name = row.text("name");
  result.class_name = row.text("class");
  result.map = row.optional_integer("map");
  result.height = row.optional_real("height");
  if (const auto outline = row.optional_text("outline"))
    for (const Json& point : parse_json(*outline, "place.outline"))
      result.outline.emplace_back(point.at(0).get<double>(), point.at(1).get<double>());
  result.map_from_place = row.pose("");
  result.container = row.integer("container") != 0;
  result.joint = row.optional_text("joint");
  return result;
}

SceneRow scene_row(const SqlRow& row) {
  SceneRow result;
  result.id = row.integer("id");
  result.recording = row.optional_integer("recording");
  result.frame_index = row.optional_integer("frame_index");
  result.time = row.integer("time");
  result.map = row.optional_integer("map");
  if (!row.is_null("camera_width") && !row.is_null("fx")) {
    SceneCamera camera;
    camera.width = static_cast<int>(row.integer("camera_width"));
    camera.height = static_cast<int>(row.integer("camera_height"));
    camera.fx = row.real("fx");
    camera.fy = row.real("fy");
    camera.cx = row.real("cx");
    camera.cy = row.real("cy");
    camera.range_min = row.optional_real("range_min");
    camera.range_max = row.optional_real("range_max");
    result.camera = camera;
  }
  result.map_from_camera = row.pose("");
  result.depth = row.optional_integer("depth");
  result.depth_width = static_cast<int>(row.optional_integer("depth_width").value_or(0));
  result.depth_height = static_cast<int>(row.optional_integer("depth_height").value_or(0));
  result.picture = row.optional_integer("picture");
  if (const auto text = row.optional_text("joints")) {
    const Json joints = parse_json(*text, "scene.joints");
    for (const auto& [joint, position] : joints.items()) result.joints[joint] = position.get<double>();
  }
  result.known_from = row.integer("known_from");
  result.run = row.integer("run");
  return result;
}

ObservationRow observation_row(const SqlRow& row) {
  ObservationRow result;
  result.id = row.integer("id");
  result.scene = row.integer("scene");
  result.number = row.integer("number");
  result.place = row.optional_integer("place");
  result.position = row.vector("");
  result.map_from_box = row.pose("box_");
  result.size = row.vector("size_");
  result.hsv = row.color();
  result.color = row.optional_text("color");
  result.points = row.optional_integer("points");
  result.crop = row.optional_integer("crop");
  result.mask = row.optional_integer("mask");
  if (!row.is_null("roi_x"))
    result.roi = {static_cast<int>(row.integer("roi_x")), static_cast<int>(row.integer("roi_y")),
                  static_cast<int>(row.integer("roi_width")), static_cast<int>(row.integer("roi_height"))};
  result.sentence = row.optional_text("sentence");
  return result;
}

EventRow event_row(const SqlRow& row) {
  EventRow result;
  result.id = row.integer("id");
  result.scene = row.optional_integer("scene");
  result.kind = row.text("kind");
  result.object = row.optional_integer("object");
  result.observation = row.optional_integer("observation");
  result.place = row.optional_integer("place");
  result.from_place = row.optional_integer("from_place");
  result.position = row.vector("");
  result.from_position = row.vector("from_");
  result.joint = row.optional_text("joint");
  result.joint_position = row.optional_real("position");
  result.from_joint_position = row.optional_real("from_position");
  result.probability = row.real("probability");
  result.since = row.optional_integer("since");
  result.clock = row.clock();
  return result;
}

}  // namespace

AssociationRow association_row(const SqlRow& row) {
  AssociationRow result;
  result.id = row.integer("id");
  result.scene = row.integer("scene");
  result.observation = row.optional_integer("observation");
  result.object = row.optional_integer("object");
  result.explanation = row.text("explanation");
  result.probability = row.real("probability");
  result.chosen = row.integer("chosen") != 0;
  result.clock = row.clock();
  return result;
}

BeliefRow belief_row(const SqlRow& row) {
  BeliefRow result;
  result.id = row.integer("id");
  result.object = row.integer("object");
  result.scene = row.optional_integer("scene");
  result.status = row.text("status");
  result.probability = row.real("probability");
  result.place = row.optional_integer("place");
  result.position = row.vector("");
  result.sigma = row.optional_real("sigma");
  result.last_scene = row.optional_integer("last_scene");
  result.last_observation = row.optional_integer("last_observation");
  result.hsv = row.color();
  result.color = row.optional_text("color");
  result.size = row.vector("size_");
  result.fade_s = row.optional_real("fade_s");
  result.fade_to = row.optional_real("fade_to");
  result.clock = row.clock();
  result.probability_then = result.probability;
  result.then = result.clock.valid_from;
  return result;
}

namespace {

VisibilityRow visibility_row(const SqlRow& row) {
  VisibilityRow result;
  result.id = row.integer("id");
  result.scene = row.integer("scene");
  result.object = row.optional_integer("object");
  result.place = row.optional_integer("place");
  result.status = row.text("status");
  result.probability = row.optional_real("probability");
  result.fraction = row.optional_real("fraction");
  return result;
}

}  // namespace

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

Id Store::last_observation() const {
  return all<Id>(*implementation_, "SELECT coalesce(max(id), 0) AS id FROM observation", {},
                 [](const SqlRow& row) { return row.integer("id"); })
      .front();
}

Id Store::last_object() const {
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

std::vector<ObjectRow> Store::objects(const AsOf& as_of) const {
  std::vector<SqlValue> values;
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, false);
  return all<ObjectRow>(*implementation_,
                        fmt::format("SELECT * FROM object_known WHERE {} AND {} ORDER BY id", known, valid),
                        values, [](const SqlRow& row) {
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
std::vector<Sighting> sightings_where(Store::Implementation& store, const std::string& condition,
                                      const std::string& order, const std::vector<SqlValue>& values) {
  const std::string chosen = fmt::format(
      "SELECT * FROM association_known WHERE object = ?1 AND chosen = 1 AND observation IS NOT NULL AND "
      "probability > 0 AND {} ORDER BY {}",
      condition, order);
  std::vector<Sighting> result;
  for (AssociationRow& association : all<AssociationRow>(store, chosen, values, association_row))
    result.push_back({std::move(association)});
  // The same rows in the same order, seen from their observations.
  SQLite::Statement& seen = store.statement(
      "SELECT o.*, s.time AS scene_time, s.recording AS scene_recording, s.frame_index AS scene_frame FROM "
      "observation o JOIN scene s ON s.id = o.scene WHERE o.id = ?");
  store.guarded([&] {
    for (Sighting& sighting : result) {
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

std::vector<Sighting> Store::sightings(Id object, const AsOf& as_of, std::optional<TimeNs> from,
                                       std::optional<TimeNs> to) const {
  std::vector<SqlValue> values = {sql(object)};
  std::string condition = known_condition(as_of, values);
  condition +=
      " AND " + valid_condition(as_of, values, false) + range_condition("valid_from", from, to, values);
  return sightings_where(*implementation_, condition, "valid_from, id", values);
}

std::optional<Sighting> Store::last_sighting_before(Id object, TimeNs time, const std::vector<Id>& places,
                                                    const AsOf& as_of) const {
  std::vector<SqlValue> values = {sql(object), sql(time)};
  std::string condition = "valid_from < ?2 AND " + known_condition(as_of, values);
  condition += " AND " + valid_condition(as_of, values, false) + on_places(places);
  auto rows = sightings_where(*implementation_, condition, "valid_from DESC, scene DESC LIMIT 1", values);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

std::optional<Sighting> Store::first_sighting_after(Id object, TimeNs time, const std::vector<Id>& places,
                                                    const AsOf& as_of) const {
  std::vector<SqlValue> values = {sql(object), sql(time)};
  std::string condition = "valid_from > ?2 AND " + known_condition(as_of, values);
  condition += " AND " + valid_condition(as_of, values, false) + on_places(places);
  auto rows = sightings_where(*implementation_, condition, "valid_from, scene LIMIT 1", values);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
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

std::vector<VisibilityRow> Store::visibility(Id scene) const {
  return all<VisibilityRow>(*implementation_, "SELECT * FROM visibility WHERE scene = ? ORDER BY id",
                            {sql(scene)}, visibility_row);
}

namespace {

std::vector<VisibilityRow> visibility_of(Store::Implementation& store, const char* what, Id id,
                                         const Store::SceneRange& scenes) {
  std::vector<SqlValue> values = {sql(id)};
  std::string text = fmt::format("SELECT * FROM visibility WHERE {} = ?1", what);
  if (scenes) {
    text += " AND scene BETWEEN ?2 AND ?3";
    values.insert(values.end(), {sql(scenes->first), sql(scenes->second)});
  }
  return all<VisibilityRow>(store, text + " ORDER BY scene, id", values, visibility_row);
}

}  // namespace

std::vector<VisibilityRow> Store::visibility_of_object(Id object, const SceneRange& scenes) const {
  return visibility_of(*implementation_, "object", object, scenes);
}

std::vector<VisibilityRow> Store::visibility_of_place(Id place, const SceneRange& scenes) const {
  return visibility_of(*implementation_, "place", place, scenes);
}

std::optional<VisibilityRow> Store::last_look(Id place, const AsOf& as_of) const {
  std::vector<SqlValue> values = {sql(place)};
  const std::string range = range_condition("s.time", {}, as_of.at, values) +
                            range_condition("s.known_from", {}, as_of.known_at, values);
  // Backwards through the scenes, if the place was ever looked at: the last look is seldom long ago.
  auto rows = all<VisibilityRow>(*implementation_,
                                 "SELECT v.* FROM scene s CROSS JOIN visibility v ON v.scene = s.id WHERE "
                                 "v.place = ?1 AND v.fraction > 0" +
                                     range +
                                     " AND EXISTS (SELECT 1 FROM visibility w WHERE w.place = ?1) ORDER BY "
                                     "s.time DESC, s.id DESC LIMIT 1",
                                 values, visibility_row);
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

std::vector<FactRow> Store::facts(const AsOf& as_of) const {
  std::vector<SqlValue> values;
  const std::string known = known_condition(as_of, values), valid = valid_condition(as_of, values, true);
  return all<FactRow>(
      *implementation_,
      fmt::format("SELECT * FROM fact_known WHERE value IS NOT NULL AND {} AND {} ORDER BY id", known, valid),
      values, [](const SqlRow& row) {
        FactRow fact;
        fact.id = row.integer("id");
        fact.object = row.optional_integer("object");
        fact.place = row.optional_integer("place");
        fact.key = row.text("key");
        fact.value = row.optional_text("value");
        fact.probability = row.optional_real("probability");
        fact.clock = row.clock();
        return fact;
      });
}

std::optional<std::string> Store::reasoning(Id scene) const {
  const auto& path = implementation_->path;
  auto rows = all<std::string>(*implementation_, "SELECT encoding, content FROM reasoning WHERE scene = ?",
                               {sql(scene)}, [&](const SqlRow& row) {
                                 return decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path);
                               });
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

std::optional<Store::Checkpoint> Store::checkpoint(const std::string& name) const {
  const auto& path = implementation_->path;
  auto rows = all<Checkpoint>(
      *implementation_, "SELECT * FROM checkpoint WHERE name = ?", {sql(name)}, [&](const SqlRow& row) {
        return Checkpoint{row.optional_integer("scene"),
                          decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path)};
      });
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

BlobRow Store::blob(Id id) const {
  const auto& path = implementation_->path;
  return one<BlobRow>(*implementation_, "blob", id, [&](const SqlRow& row) {
    return BlobRow{row.integer("id"), row.text("hash"), row.text("media"),
                   decode_bytes(row.bytes("content"), row.integer("encoding"), row.integer("size"), path)};
  });
}

std::optional<Id> Store::find_blob(const std::string& hash) const {
  const auto rows = all<Id>(*implementation_, "SELECT id FROM blob WHERE hash = ?", {sql(hash)},
                            [](const SqlRow& row) { return row.integer("id"); });
  return rows.empty() ? std::nullopt : std::optional(rows[0]);
}

std::map<std::string, Store::Checkpoint> Store::checkpoints(const std::string& prefix) const {
  const auto& path = implementation_->path;
  std::map<std::string, Checkpoint> result;
  implementation_->guarded([&] {
    implementation_->query("SELECT * FROM checkpoint WHERE substr(name, 1, length(?1)) = ?1", {sql(prefix)},
                           [&](const SqlRow& row) {
                             result[row.text("name")] = {
                                 row.optional_integer("scene"),
                                 decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path)};
                           });
  });
  return result;
}

namespace {

FeatureStructureRow feature_structure_row(const SqlRow& row, const std::filesystem::path& path) {
  FeatureStructureRow result;
  result.id = row.integer("id");
  result.scene = row.optional_integer("scene");
  result.observation = row.optional_integer("observation");
  result.type = row.text("type");
  result.type_system = row.integer("type_system");
  result.json = decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path);
  return result;
}

}  // namespace

FeatureStructureRow Store::feature_structure(Id id) const {
  auto& s = *implementation_;
  auto result = one<FeatureStructureRow>(
      s, "feature_structure", id, [&](const SqlRow& row) { return feature_structure_row(row, s.path); });
  result.blobs =
      all<Id>(s, "SELECT blob FROM feature_structure_blob WHERE feature_structure = ? ORDER BY blob",
              {sql(id)}, [](const SqlRow& row) { return row.integer("blob"); });
  return result;
}

std::vector<FeatureStructureRow> Store::feature_structures(Id scene, const std::string& type) const {
  std::vector<SqlValue> values = {sql(scene)};
  std::string text = "SELECT id FROM feature_structure WHERE scene = ?1";
  if (!type.empty()) {
    text += " AND type = ?2";
    values.push_back(sql(type));
  }
  std::vector<FeatureStructureRow> result;
  for (const Id id : all<Id>(*implementation_, text + " ORDER BY id", values,
                             [](const SqlRow& row) { return row.integer("id"); }))
    result.push_back(feature_structure(id));
  return result;
}

std::string Store::type_system(Id id) const {
  const Id content =
      one<Id>(*implementation_, "type_system", id, [](const SqlRow& row) { return row.integer("content"); });
  return blob(content).bytes;
}

}  // namespace loci
