#include "memory/store/scene_transaction.h"

#include "mapping/base/hash.h"
#include "mapping/base/json.h"
#include "memory/store/database.h"

namespace loci::memory {
namespace {

Bitemporal stamped(Bitemporal clock, TimeNs scene_time, TimeNs known, Id run) {
  if (clock.valid_from == 0) clock.valid_from = scene_time;
  clock.known_from = known;
  clock.run = run;
  return clock;
}

}  // namespace

SceneTransaction::SceneTransaction(Store& store, Id run)
    : store_(*store.implementation_), run_(run), known_(store_.known_time()) {
  store_.need_writable();
  store_.guarded([&] { store_.database->exec("BEGIN IMMEDIATE"); });
  store_.in_scene = true;
  store_.added.clear();
  store_.just_seen.clear();
}

SceneTransaction::~SceneTransaction() {
  if (!open_) return;
  store_.in_scene = false;
  for (auto& [text, statement] : store_.statements) statement->tryReset();
  store_.forget_cached();
  store_.database->tryExec("ROLLBACK");
}

void SceneTransaction::commit() {
  store_.guarded([&] {
    store_.keep_counts();
    store_.database->exec("COMMIT");
  });
  store_.in_scene = false;
  open_ = false;
}

Id SceneTransaction::add_scene(const SceneRow& row) {
  scene_time_ = row.time;
  std::optional<std::string> joints;
  if (!row.joints.empty()) {
    Json positions = Json::object();
    for (const auto& [joint, position] : row.joints) positions[joint] = position;
    joints = positions.dump();
  }
  const auto& camera = row.camera;
  const auto number = [&](double SceneCamera::*field) { return camera ? sql((*camera).*field) : SqlValue(); };
  SqlColumns columns = {{"recording", sql(row.recording)},
                        {"frame_index", sql(row.frame_index)},
                        {"time", sql(row.time)},
                        {"map", sql(row.map)},
                        {"camera_width", camera ? sql(camera->width) : SqlValue()},
                        {"camera_height", camera ? sql(camera->height) : SqlValue()},
                        {"fx", number(&SceneCamera::fx)},
                        {"fy", number(&SceneCamera::fy)},
                        {"cx", number(&SceneCamera::cx)},
                        {"cy", number(&SceneCamera::cy)},
                        {"range_min", camera ? sql(camera->range_min) : SqlValue()},
                        {"range_max", camera ? sql(camera->range_max) : SqlValue()},
                        {"depth", sql(row.depth)},
                        {"depth_width", row.depth ? sql(row.depth_width) : SqlValue()},
                        {"depth_height", row.depth ? sql(row.depth_height) : SqlValue()},
                        {"image", sql(row.image)},
                        {"joints", sql(joints)},
                        {"kinds", sql(row.kinds)},
                        {"known_from", sql(known_)},
                        {"run", sql(run_)}};
  add_pose(columns, "", row.map_from_camera);
  return store_.guarded([&] {
    const Id id = store_.insert("scene", columns);
    store_.mark_scene(id, row.time);
    return id;
  });
}

Id SceneTransaction::add_place(const PlaceRow& row) {
  return store_.guarded([&] { return store_.add_place(row, run_, known_); });
}

Id SceneTransaction::add_blob(std::string_view bytes, const std::string& media) {
  return store_.guarded([&] { return store_.add_blob(bytes, media); });
}

Id SceneTransaction::add_observation(const ObservationRow& row) {
  SqlColumns columns = {
      {"scene", sql(row.scene)}, {"number", sql(row.number)},     {"place", sql(row.place)},
      {"color", sql(row.color)}, {"points", sql(row.points)},     {"crop", sql(row.crop)},
      {"mask", sql(row.mask)},   {"sentence", sql(row.sentence)}, {"cloud", sql(row.cloud)}};
  const char* const roi[] = {"roi_x", "roi_y", "roi_width", "roi_height"};
  for (size_t i = 0; i < 4; ++i) columns.emplace_back(roi[i], row.roi ? sql((*row.roi)[i]) : SqlValue());
  add_vector(columns, "", row.position);
  add_pose(columns, "box_", row.map_from_box);
  add_vector(columns, "size_", row.size);
  add_color(columns, row.hsv);
  return store_.guarded([&] {
    const Id id = store_.insert("observation", columns);
    store_.just_seen[id].place = row.place.value_or(0);
    return id;
  });
}

Id SceneTransaction::add_annotation(const AnnotationRow& row) {
  return store_.guarded([&] {
    const Id term = store_.add_term(row.type, row.value);
    const auto fresh = row.observation ? store_.just_seen.find(*row.observation) : store_.just_seen.end();
    if (fresh != store_.just_seen.end()) fresh->second.terms.push_back(term);
    if (row.observation && (fresh == store_.just_seen.end() || fresh->second.associated))
      // Said later than it was decided what it is.
      store_.query(
          "SELECT object, valid_from FROM association WHERE observation = ? AND chosen = 1 AND probability > "
          "0 AND object IS NOT NULL",
          {sql(*row.observation)}, [&](const SqlRow& association) {
            store_.add_object_term(association.integer("object"), term, association.integer("valid_from"));
          });
    return store_.insert("annotation", {{"scene", sql(row.scene)},
                                        {"observation", sql(row.observation)},
                                        {"term", sql(term)},
                                        {"confidence", sql(row.confidence)},
                                        {"feature_structure", sql(row.feature_structure)}});
  });
}

void SceneTransaction::add_log(const LogRow& row) {
  store_.guarded([&] {
    store_.insert("scene_log", {{"scene", sql(row.scene)},
                                {"number", sql(row.number)},
                                {"annotator", sql(row.annotator)},
                                {"level", sql(row.level)},
                                {"text", row.text.empty() ? SqlValue() : sql(row.text)},
                                {"milliseconds", sql(row.milliseconds)}});
  });
}

Id SceneTransaction::add_type_system(std::string_view text) {
  const std::string hash = content_hash(text);
  return store_.guarded([&] {
    std::optional<Id> known;
    store_.query("SELECT id FROM type_system WHERE hash = ?", {sql(hash)},
                 [&](const SqlRow& row) { known = row.integer("id"); });
    if (known) return *known;
    const Id content = store_.add_blob(text, "application/xml");
    return store_.insert("type_system", {{"hash", sql(hash)}, {"content", sql(content)}});
  });
}

Id SceneTransaction::add_feature_structure(const FeatureStructureRow& row) {
  // Small ones stay readable for people; large ones are packed.
  const Encoded encoded = row.json.size() < 4096 ? Encoded{0, row.json} : encode_bytes(row.json);
  return store_.guarded([&] {
    const Id id = store_.insert("feature_structure", {{"scene", sql(row.scene)},
                                                      {"observation", sql(row.observation)},
                                                      {"type", sql(row.type)},
                                                      {"type_system", sql(row.type_system)},
                                                      {"encoding", sql(encoded.encoding)},
                                                      {"content", BytesView{encoded.bytes}}});
    for (const Id blob : row.blobs) {
      SQLite::Statement& link = store_.statement(
          "INSERT OR IGNORE INTO feature_structure_blob (feature_structure, blob) VALUES (?, ?)");
      bind_values(link, {sql(id), sql(blob)});
      link.exec();
    }
    return id;
  });
}

Id SceneTransaction::add_object(const ObjectRow& row) {
  SqlColumns columns;
  const Bitemporal clock = stamped(row.clock, scene_time_, known_, run_);
  add_clock(columns, clock);
  return store_.guarded([&] { return store_.insert("object", columns); });
}

Id SceneTransaction::add_association(const AssociationRow& row) {
  SqlColumns columns = {{"scene", sql(row.scene)},
                        {"observation", sql(row.observation)},
                        {"object", sql(row.object)},
                        {"explanation", sql(row.explanation)},
                        {"probability", sql(row.probability)},
                        {"chosen", sql(row.chosen)}};
  Bitemporal clock = stamped(row.clock, scene_time_, known_, run_);
  if (!clock.valid_to) clock.valid_to = clock.valid_from;  // It is about one moment.
  add_clock(columns, clock);
  return store_.guarded([&] {
    if (row.chosen && row.object && row.observation && row.probability > 0) {
      const auto fresh = store_.just_seen.find(*row.observation);
      if (fresh != store_.just_seen.end()) {
        fresh->second.associated = true;
        for (const Id term : fresh->second.terms) store_.add_object_term(*row.object, term, clock.valid_from);
      } else {
        store_.query("SELECT term FROM annotation WHERE scene = ? AND observation = ?",
                     {sql(row.scene), sql(*row.observation)}, [&](const SqlRow& annotation) {
                       store_.add_object_term(*row.object, annotation.integer("term"), clock.valid_from);
                     });
      }
      const Id id = store_.insert("association", columns);
      store_.mark_sighting(*row.object, *row.observation, clock.valid_from, row.scene);
      return id;
    }
    return store_.insert("association", columns);
  });
}

Id SceneTransaction::add_event(const EventRow& row) {
  SqlColumns columns = {{"scene", sql(row.scene)},
                        {"kind", sql(row.kind)},
                        {"object", sql(row.object)},
                        {"observation", sql(row.observation)},
                        {"place", sql(row.place)},
                        {"from_place", sql(row.from_place)},
                        {"joint", sql(row.joint)},
                        {"position", sql(row.joint_position)},
                        {"from_position", sql(row.from_joint_position)},
                        {"probability", sql(row.probability)},
                        {"since", sql(row.since)}};
  add_vector(columns, "", row.position);
  add_vector(columns, "from_", row.from_position);
  Bitemporal clock = stamped(row.clock, scene_time_, known_, run_);
  if (!clock.valid_to) clock.valid_to = clock.valid_from;
  add_clock(columns, clock);
  return store_.guarded([&] { return store_.insert("event", columns); });
}

Id SceneTransaction::add_belief(const BeliefRow& row) {
  SqlColumns columns = {{"object", sql(row.object)},         {"scene", sql(row.scene)},
                        {"status", sql(row.status)},         {"probability", sql(row.probability)},
                        {"place", sql(row.place)},           {"sigma", sql(row.sigma)},
                        {"last_scene", sql(row.last_scene)}, {"last_observation", sql(row.last_observation)},
                        {"color", sql(row.color)},           {"fade_s", sql(row.fade_s)},
                        {"fade_to", sql(row.fade_to)}};
  add_vector(columns, "", row.position);
  add_vector(columns, "size_", row.size);
  add_color(columns, row.hsv);
  const Bitemporal clock = stamped(row.clock, scene_time_, known_, run_);
  add_clock(columns, clock);
  return store_.guarded([&] {
    const Id id = store_.insert("belief", columns);
    store_.add_stay(id, row, clock.valid_from);
    return id;
  });
}

Id SceneTransaction::add_visibility(const VisibilityRow& row) {
  return store_.guarded([&] {
    return store_.insert("visibility", {{"scene", sql(row.scene)},
                                        {"object", sql(row.object)},
                                        {"place", sql(row.place)},
                                        {"status", sql(row.status)},
                                        {"probability", sql(row.probability)},
                                        {"fraction", sql(row.fraction)},
                                        {"valid_from", sql(scene_time_)},
                                        {"known_from", sql(known_)},
                                        {"run", sql(run_)}});
  });
}

Id SceneTransaction::add_fact(const FactRow& row) {
  FactRow with_time = row;
  if (with_time.clock.valid_from == 0) with_time.clock.valid_from = scene_time_;
  return store_.guarded([&] { return store_.add_fact(with_time, run_, known_); });
}

void SceneTransaction::set_reasoning(Id scene, std::string_view bytes) {
  const Encoded encoded = encode_bytes(bytes);
  store_.guarded([&] {
    SQLite::Statement& statement =
        store_.statement("INSERT INTO reasoning (scene, encoding, content) VALUES (?, ?, ?)");
    bind_values(statement, {sql(scene), sql(encoded.encoding), BytesView{encoded.bytes}});
    statement.exec();
    ++store_.added["reasoning"];
  });
}

void SceneTransaction::set_checkpoint(const std::string& name, std::string_view bytes,
                                      std::optional<Id> scene) {
  // Small ones are written again and again, and only the last is kept.
  const Encoded encoded = bytes.size() < 4096 ? Encoded{0, std::string(bytes)} : encode_bytes(bytes);
  store_.guarded([&] {
    SQLite::Statement& statement = store_.statement(
        "INSERT INTO checkpoint (name, scene, encoding, content) VALUES (?, ?, ?, ?) ON CONFLICT DO UPDATE "
        "SET "
        "scene = excluded.scene, encoding = excluded.encoding, content = excluded.content");
    bind_values(statement, {sql(name), sql(scene), sql(encoded.encoding), BytesView{encoded.bytes}});
    statement.exec();
  });
}

void SceneTransaction::drop_checkpoints(const std::string& prefix) {
  store_.guarded([&] {
    // The names from the prefix on to the first that begins otherwise.
    std::string end = prefix;
    ++end.back();
    SQLite::Statement& statement = store_.statement("DELETE FROM checkpoint WHERE name >= ? AND name < ?");
    bind_values(statement, {sql(prefix), sql(end)});
    statement.exec();
  });
}

}  // namespace loci::memory
