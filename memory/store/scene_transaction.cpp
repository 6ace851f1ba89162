#include "memory/store/scene_transaction.h"

#include "mapping/base/text/hash.h"
#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/digest.h"
#include "memory/store/rows/row_columns.h"

namespace loci::memory {
SceneTransaction::SceneTransaction(Store& store, Id run)
    : db_(*store.connection_), run_(run), known_(db_.known_time()) {
  db_.require_writable();
  db_.guarded([&] { db_.begin(); });
  db_.in_scene = true;
  db_.new_observations.clear();
}

SceneTransaction::~SceneTransaction() {
  if (!open_) return;
  db_.in_scene = false;
  db_.roll_back();
}

void SceneTransaction::commit() {
  db_.guarded([&] {
    if (postponed_) {
      db_.clear_caches();
      derive_tables(*db_.database);
    }
    db_.commit();
  });
  db_.in_scene = false;
  open_ = false;
}

ChangeTransaction::ChangeTransaction(Store& store) : db_(*store.connection_) {
  db_.require_writable();
  db_.guarded([&] { db_.begin(); });
}

ChangeTransaction::~ChangeTransaction() {
  if (open_) db_.roll_back();
}

void ChangeTransaction::commit() {
  db_.guarded([&] { db_.commit(); });
  open_ = false;
}

template <class Row>
Row SceneTransaction::stamped(const Row& row, bool momentary) const {
  Row result = row;
  if (result.clock.valid_from == 0) result.clock.valid_from = scene_time_;
  if (momentary && !result.clock.valid_to) result.clock.valid_to = result.clock.valid_from;
  result.clock.known_from = known_;
  result.clock.run = run_;
  return result;
}

Id SceneTransaction::add_scene(const SceneRow& row) {
  scene_time_ = row.time;
  SceneRow scene = row;
  scene.known_from = known_;
  scene.run = run_;
  return db_.guarded([&] {
    const Id id = insert_row(db_, scene);
    db_.rank_scene(id, scene.time);
    return id;
  });
}

Id SceneTransaction::add_place(const PlaceRow& row) {
  return db_.guarded([&] { return db_.add_place(row, run_, known_); });
}

Id SceneTransaction::add_blob(std::string_view bytes, const std::string& media) {
  return db_.guarded([&] { return db_.add_blob(bytes, media); });
}

Id SceneTransaction::add_observation(const ObservationRow& row) {
  return db_.guarded([&] {
    const Id id = insert_row(db_, row);
    db_.new_observations[id].place = row.place.value_or(0);
    return id;
  });
}

Id SceneTransaction::add_annotation(const AnnotationRow& row) {
  return db_.guarded([&] {
    const Id term = db_.add_term(row.type, row.value);
    if (row.observation) {
      const auto added = db_.new_observations.find(*row.observation);
      if (added != db_.new_observations.end()) added->second.terms.push_back(term);
      if (added == db_.new_observations.end() || added->second.associated)
        db_.query(
            "SELECT object, valid_from FROM association WHERE observation = ? AND chosen = 1 AND probability "
            "> 0 AND "
            "object IS NOT NULL",
            {sql(*row.observation)}, [&](const SqlRow& association) {
              db_.add_object_term(association.get<Id>("object"), term, association.get<TimeNs>("valid_from"));
            });
    }
    return db_.insert("annotation", {{"scene", sql(row.scene)},
                                     {"observation", sql(row.observation)},
                                     {"term", sql(term)},
                                     {"confidence", sql(row.confidence)},
                                     {"feature_structure", sql(row.feature_structure)}});
  });
}

void SceneTransaction::add_log(const LogRow& row) {
  db_.guarded([&] { insert_row(db_, row); });
}

Id SceneTransaction::add_type_system(std::string_view text) {
  const std::string hash = content_hash(text);
  return db_.guarded([&] {
    if (const auto known = db_.value<Id>("SELECT id FROM type_system WHERE hash = ?", {sql(hash)}))
      return *known;
    const Id content = db_.add_blob(text, "application/xml");
    return db_.insert("type_system", {{"hash", sql(hash)}, {"content", sql(content)}});
  });
}

Id SceneTransaction::add_feature_structure(const FeatureStructureRow& row) {
  // Small ones stay readable for people.
  const Encoded encoded = row.json.size() < 4096 ? Encoded{0, row.json} : encode_bytes(row.json);
  return db_.guarded([&] {
    const Id id = db_.insert("feature_structure", {{"scene", sql(row.scene)},
                                                   {"observation", sql(row.observation)},
                                                   {"type", sql(row.type)},
                                                   {"type_system", sql(row.type_system)},
                                                   {"encoding", sql(encoded.encoding)},
                                                   {"content", BytesView{encoded.bytes}}});
    for (const Id blob : std::set(row.blobs.begin(), row.blobs.end()))
      db_.insert("feature_structure_blob", {{"feature_structure", sql(id)}, {"blob", sql(blob)}});
    return id;
  });
}

Id SceneTransaction::add_object(const ObjectRow& row) {
  return db_.guarded([&] { return insert_row(db_, stamped(row), {{"id", sql(db_.next_object_id())}}); });
}

Id SceneTransaction::add_association(const AssociationRow& row) {
  const AssociationRow association = stamped(row, true);
  const TimeNs time = association.clock.valid_from;
  return db_.guarded([&] {
    if (postponed_ || !row.chosen || !row.object || !row.observation || row.probability <= 0)
      return insert_row(db_, association);
    const auto added = db_.new_observations.find(*row.observation);
    if (added != db_.new_observations.end()) {
      added->second.associated = true;
      for (const Id term : added->second.terms) db_.add_object_term(*row.object, term, time);
    } else {
      for (const Id term : db_.values<Id>("SELECT term FROM annotation WHERE scene = ? AND observation = ?",
                                          {sql(row.scene), sql(*row.observation)}))
        db_.add_object_term(*row.object, term, time);
    }
    const Id id = insert_row(db_, association);
    db_.rank_observation(*row.object, *row.observation, time, row.scene);
    return id;
  });
}

Id SceneTransaction::add_event(const EventRow& row) {
  return db_.guarded([&] { return insert_row(db_, stamped(row, true)); });
}

Id SceneTransaction::add_belief(const BeliefRow& row) {
  const BeliefRow belief = stamped(row);
  return db_.guarded([&] {
    const Id id = insert_row(db_, belief);
    if (!postponed_) db_.add_stay(id, belief, belief.clock.valid_from);
    return id;
  });
}

Id SceneTransaction::add_visibility(const VisibilityRow& row) {
  VisibilityRow visibility = row;
  if (visibility.time == 0) visibility.time = scene_time_;
  return db_.guarded([&] {
    return insert_row(db_, visibility, {{"known_from", sql(known_)}, {"run", sql(run_)}});
  });
}

Id SceneTransaction::add_fact(const FactRow& row) {
  return db_.guarded([&] { return insert_row(db_, stamped(row)); });
}

void SceneTransaction::set_reasoning(Id scene, std::string_view bytes) {
  const Encoded encoded = encode_bytes(bytes);
  db_.guarded([&] {
    SQLite::Statement& old = db_.statement("SELECT scene, encoding, content FROM reasoning WHERE scene = ?");
    bind_values(old, {sql(scene)});
    if (old.executeStep()) {
      db_.digests["reasoning"] -= row_digest("reasoning", old);
      --db_.added["reasoning"];
      old.reset();
      db_.run("DELETE FROM reasoning WHERE scene = ?", {sql(scene)});
    }
    db_.insert(
        "reasoning",
        {{"scene", sql(scene)}, {"encoding", sql(encoded.encoding)}, {"content", BytesView{encoded.bytes}}});
  });
}

void SceneTransaction::set_checkpoint(const std::string& name, std::string_view bytes,
                                      std::optional<Id> scene) {
  // Small ones are written again with every scene.
  const Encoded encoded = bytes.size() < 4096 ? Encoded{0, std::string(bytes)} : encode_bytes(bytes);
  db_.guarded([&] {
    db_.run(
        "INSERT INTO checkpoint (name, scene, encoding, content) VALUES (?, ?, ?, ?) ON CONFLICT DO UPDATE "
        "SET "
        "scene = excluded.scene, encoding = excluded.encoding, content = excluded.content",
        {sql(name), sql(scene), sql(encoded.encoding), BytesView{encoded.bytes}});
  });
}

void SceneTransaction::drop_checkpoints(const std::string& prefix) {
  std::string end = prefix;  // the first name that does not have the prefix
  ++end.back();
  db_.guarded([&] {
    db_.run("DELETE FROM checkpoint WHERE name >= ? AND name < ?", {sql(prefix), sql(end)});
  });
}

}  // namespace loci::memory
