// Reading: runs, recordings, places, scenes, events, facts, stored bytes, and the file as a whole.

#include <algorithm>
#include <array>

#include "memory/store/rows/row_columns.h"
#include "memory/store/rows/schema_check.h"

namespace loci::memory {
namespace {

std::vector<VisibilityRow> visibility_of(Store::Connection& db, const char* column, Id id,
                                         std::optional<TimeNs> from, std::optional<TimeNs> to) {
  Where where(fmt::format("{} = ?1", column), {sql(id)});
  if (db.needs_known({})) where.newest_visibility({});
  return select<VisibilityRow>(db, where.between("valid_from", from, to), "valid_from, id");
}

std::string decoded(const SqlRow& row, const std::filesystem::path& path, int64_t size = -1) {
  return decode_bytes(row.bytes("content"), row.get<int64_t>("encoding"), size, path);
}

/// The table that an index, or a shadow table of R*Tree or full text, belongs to.
std::map<std::string, std::string> table_owners(Store::Connection& db) {
  std::map<std::string, std::string> result;
  db.query(
      "SELECT name, tbl_name FROM sqlite_master WHERE type IN ('table', 'index')", {},
      [&](const SqlRow& row) { result[row.get<std::string>("name")] = row.get<std::string>("tbl_name"); });
  for (auto& [name, table] : result)
    for (const char* parent : {"stay", "term_text"})
      if (table.starts_with(std::string(parent) + "_")) table = parent;
  return result;
}

SQLite::Statement all_rows(Store::Connection& db, const std::string& view) {
  if (!has_object(db.format, "view", view)) throw db.error("there is no view " + view);
  return {*db.database, "SELECT * FROM " + sql_name(view)};
}

Json cell_of(const SQLite::Column& value) {
  if (value.isInteger()) return value.getInt64();
  if (value.isFloat()) return value.getDouble();
  if (value.isText()) return value.getString();
  return {};
}

/// Scenes of a period with an annotation of a type.
Where where_annotated(const std::string& type, TimeNs from, TimeNs to, const AsOf& as_of) {
  Where where;
  const std::string terms = fmt::format("SELECT id FROM term WHERE type = {}", where.bind(sql(type)));
  // Where no term is of the type, no scene is read.
  where.between("time", from, to).added("time", as_of).and_also(fmt::format("EXISTS ({})", terms));
  where.and_also(
      fmt::format("EXISTS (SELECT 1 FROM annotation a WHERE a.scene = scene.id AND a.term IN ({}))", terms));
  return where;
}

}  // namespace

std::optional<std::string> Store::meta(const std::string& key) const {
  return connection_->value<std::string>("SELECT value FROM meta WHERE key = ?", {sql(key)});
}

TimeZone Store::time_zone() const {
  const std::string name = meta("time_zone").value_or("UTC");
  try {
    return TimeZone::named(name);
  } catch (const Error& problem) {
    throw error(problem.what(), "install tzdata, or set another one with loci-memory time-zone");
  }
}

std::vector<RunRow> Store::runs() const {
  return select<RunRow>(*connection_);
}

std::vector<RecordingRow> Store::recordings() const {
  return select<RecordingRow>(*connection_);
}

std::optional<RecordingRow> Store::recording(const std::string& fingerprint) const {
  return select_first<RecordingRow>(*connection_, Where("fingerprint = ?1", {sql(fingerprint)}));
}

std::set<int64_t> Store::frames(Id recording) const {
  const auto frames = connection_->values<int64_t>(
      "SELECT frame_index FROM scene WHERE recording = ? AND frame_index IS NOT NULL", {sql(recording)});
  return {frames.begin(), frames.end()};
}

std::vector<MapRow> Store::maps() const {
  return select<MapRow>(*connection_);
}

std::vector<PlaceRow> Store::places() const {
  return select<PlaceRow>(*connection_);
}

std::vector<SceneRow> Store::scenes(const AsOf& as_of, std::optional<TimeNs> from,
                                    std::optional<TimeNs> to) const {
  return select<SceneRow>(*connection_, Where().between("time", from, to).added("time", as_of), "time, id");
}

SceneRow Store::scene(Id id) const {
  return select_by_id<SceneRow>(*connection_, id);
}

std::optional<SceneRow> Store::last_scene() const {
  return select_first<SceneRow>(*connection_, Where(), "id DESC");
}

std::optional<SceneRow> Store::latest_scene(const AsOf& as_of) const {
  return select_first<SceneRow>(*connection_, Where().added("time", as_of), "time DESC, id DESC");
}

std::optional<SceneRow> Store::latest_scene_of_joint(const std::string& joint, const AsOf& as_of,
                                                     std::optional<Id> before) const {
  Where where("EXISTS (SELECT 1 FROM json_each(scene.joints) WHERE key = ?1)", {sql(joint)});
  where.added("time", as_of);
  if (before) where.and_also("id < " + where.bind(sql(*before)));
  return select_first<SceneRow>(*connection_, where, "time DESC, id DESC");
}

std::optional<TimeNs> Store::last_scene_time() const {
  return connection_->value<TimeNs>("SELECT time FROM scene ORDER BY time DESC LIMIT 1");
}

std::vector<TimeNs> Store::scene_times_at_ends(size_t count) const {
  return connection_->values<TimeNs>(
      "SELECT time FROM (SELECT id, time FROM (SELECT id, time FROM scene ORDER BY time, id LIMIT ?1) UNION "
      "SELECT id, time FROM (SELECT id, time FROM scene ORDER BY time DESC, id DESC LIMIT ?1)) ORDER BY "
      "time, "
      "id",
      {sql(static_cast<int64_t>(count))});
}

std::vector<ObservationRow> Store::observations(Id scene) const {
  return select<ObservationRow>(*connection_, Where("scene = ?1", {sql(scene)}), "number");
}

ObservationRow Store::observation(Id id) const {
  return select_by_id<ObservationRow>(*connection_, id);
}

Id Store::max_observation_id() const {
  return *connection_->value<Id>("SELECT coalesce(max(id), 0) FROM observation");
}

Id Store::max_object_id() const {
  return connection_->next_object_id() - 1;
}

std::vector<AnnotationRow> Store::annotations(Id scene, const AsOf& as_of) const {
  Where where("scene = ?1", {sql(scene)});
  where.and_also(fmt::format("id IN (SELECT n.id FROM annotation n WHERE n.scene = ?1 AND {})",
                             where.label_holds(as_of)));
  return select<AnnotationRow>(*connection_, where);
}

std::vector<SceneRow> Store::scenes_annotated(const std::string& type, TimeNs from, TimeNs to,
                                              const AsOf& as_of) const {
  return select<SceneRow>(*connection_, where_annotated(type, from, to, as_of), "time, id");
}

std::optional<TimeNs> Store::last_annotated(const std::string& type, TimeNs from, TimeNs to,
                                            const AsOf& as_of) const {
  const Where where = where_annotated(type, from, to, as_of);
  return connection_->value<TimeNs>(
      fmt::format("SELECT time FROM scene WHERE {} ORDER BY time DESC LIMIT 1", where.text()),
      where.values());
}

std::vector<LogRow> Store::log(Id scene) const {
  return select<LogRow>(*connection_, Where("scene = ?1", {sql(scene)}), "number");
}

std::vector<AssociationRow> Store::associations(Id scene, const AsOf& as_of) const {
  return select<AssociationRow>(*connection_, "association_known",
                                Where("scene = ?1", {sql(scene)}).known(as_of));
}

std::vector<VisibilityRow> Store::visibility(Id scene) const {
  Where where("scene = ?1", {sql(scene)});
  return select<VisibilityRow>(*connection_, where.newest_visibility({}));
}

std::vector<VisibilityRow> Store::visibility_of_object(Id object, std::optional<TimeNs> from,
                                                       std::optional<TimeNs> to) const {
  return visibility_of(*connection_, "object", object, from, to);
}

std::vector<VisibilityRow> Store::visibility_of_place(Id place, std::optional<TimeNs> from,
                                                      std::optional<TimeNs> to) const {
  return visibility_of(*connection_, "place", place, from, to);
}

std::optional<VisibilityRow> Store::visibility_before(const VisibilityRow& row) const {
  return select_first<VisibilityRow>(
      *connection_,
      Where("scene = ?1 AND object = ?2 AND id < ?3", {sql(row.scene), sql(row.object), sql(row.id)}),
      "id DESC");
}

std::optional<VisibilityRow> Store::last_visibility(Id place, const AsOf& as_of) const {
  return select_first<VisibilityRow>(
      *connection_, Where("place = ?1 AND fraction > 0", {sql(place)}).added("valid_from", as_of),
      "valid_from DESC, scene DESC");
}

std::vector<EventRow> Store::events(const AsOf& as_of, std::optional<TimeNs> from,
                                    std::optional<TimeNs> to) const {
  return select<EventRow>(*connection_, "event_known",
                          Where("probability > 0").known(as_of).begun(as_of).between("valid_from", from, to),
                          "valid_from, object, kind, id");
}

std::vector<EventRow> Store::events_of(Id object, const AsOf& as_of, std::optional<TimeNs> from,
                                       std::optional<TimeNs> to) const {
  return select<EventRow>(*connection_, "event_known",
                          Where("object = ?1 AND probability > 0", {sql(object)})
                              .known(as_of)
                              .begun(as_of)
                              .between("valid_from", from, to),
                          "valid_from, kind, id");
}

std::vector<FactRow> Store::facts(const AsOf& as_of) const {
  return select<FactRow>(*connection_, "fact_known", Where("value IS NOT NULL").known(as_of).holds(as_of));
}

template <class Row>
std::vector<Row> Store::rows_of_run(Id run) const {
  return select<Row>(*connection_, Where("run = ?1", {sql(run)}));
}

template <class Row>
Row Store::row(Id id) const {
  return select_by_id<Row>(*connection_, id);
}

template <class Row>
Id Store::current_row(Id id) const {
  const std::string later =
      fmt::format("SELECT id FROM {} WHERE supersedes = ? ORDER BY known_from, id LIMIT 1", Row::kTable);
  while (const auto next = connection_->value<Id>(later, {sql(id)})) id = *next;
  return id;
}

template <class Row>
std::vector<Row> Store::known_rows(Id scene) const {
  return select<Row>(*connection_, fmt::format("{}_known", Row::kTable),
                     Where("scene = ?1", {sql(scene)}).known({}));
}

template <>
std::vector<VisibilityRow> Store::known_rows(Id scene) const {
  return visibility(scene);
}

template std::vector<AssociationRow> Store::known_rows(Id) const;
template std::vector<EventRow> Store::known_rows(Id) const;
template std::vector<BeliefRow> Store::known_rows(Id) const;
template std::vector<VisibilityRow> Store::rows_of_run(Id) const;
template std::vector<AssociationRow> Store::rows_of_run(Id) const;
template std::vector<EventRow> Store::rows_of_run(Id) const;
template std::vector<BeliefRow> Store::rows_of_run(Id) const;
template std::vector<FactRow> Store::rows_of_run(Id) const;
template AssociationRow Store::row(Id) const;
template EventRow Store::row(Id) const;
template BeliefRow Store::row(Id) const;
template FactRow Store::row(Id) const;
template Id Store::current_row<AssociationRow>(Id) const;
template Id Store::current_row<EventRow>(Id) const;
template Id Store::current_row<BeliefRow>(Id) const;
template Id Store::current_row<FactRow>(Id) const;

std::optional<std::string> Store::reasoning(Id scene) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::optional<std::string> bytes;
    db.query("SELECT encoding, content FROM reasoning WHERE scene = ?", {sql(scene)},
             [&](const SqlRow& row) { bytes = decoded(row, db.path); });
    return bytes && bytes->empty() ? std::nullopt : bytes;
  });
}

bool Store::reasoning_discarded(Id scene) const {
  return connection_
      ->value<int64_t>("SELECT 1 FROM reasoning WHERE scene = ? AND length(content) = 0", {sql(scene)})
      .has_value();
}

size_t Store::scenes_without_reasoning() const {
  return *connection_->value<size_t>(
      "SELECT count(*) FROM scene WHERE NOT EXISTS (SELECT 1 FROM reasoning WHERE reasoning.scene = scene.id "
      "AND length(content) > 0) AND NOT EXISTS (SELECT 1 FROM forgotten f WHERE scene.time BETWEEN "
      "f.valid_from AND f.valid_to)");
}

std::optional<Store::Checkpoint> Store::checkpoint(const std::string& name) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::optional<Checkpoint> result;
    db.query("SELECT * FROM checkpoint WHERE name = ?", {sql(name)}, [&](const SqlRow& row) {
      result = {row.get<std::optional<Id>>("scene"), decoded(row, db.path)};
    });
    return result;
  });
}

std::map<std::string, Store::Checkpoint> Store::checkpoints(const std::string& prefix) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::map<std::string, Checkpoint> result;
    db.query(
        "SELECT * FROM checkpoint WHERE substr(name, 1, length(?1)) = ?1", {sql(prefix)},
        [&](const SqlRow& row) {
          result[row.get<std::string>("name")] = {row.get<std::optional<Id>>("scene"), decoded(row, db.path)};
        });
    return result;
  });
}

BlobRow Store::blob(Id id) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::optional<BlobRow> blob;
    db.query("SELECT * FROM blob WHERE id = ?", {sql(id)}, [&](const SqlRow& row) {
      blob = {id, row.get<std::string>("hash"), row.get<std::string>("media"),
              decoded(row, db.path, row.get<int64_t>("size"))};
    });
    if (!blob) throw db.error(fmt::format("no blob {}", id));
    return *std::move(blob);
  });
}

std::optional<Id> Store::find_blob(const std::string& hash) const {
  return connection_->value<Id>("SELECT id FROM blob WHERE hash = ?", {sql(hash)});
}

FeatureStructureRow Store::feature_structure(Id id) const {
  auto& db = *connection_;
  return db.guarded([&] {
    std::optional<FeatureStructureRow> result;
    db.query("SELECT * FROM feature_structure WHERE id = ?", {sql(id)}, [&](const SqlRow& row) {
      result = {.id = id,
                .scene = row.get<std::optional<Id>>("scene"),
                .observation = row.get<std::optional<Id>>("observation"),
                .type = row.get<std::string>("type"),
                .type_system = row.get<Id>("type_system"),
                .json = decoded(row, db.path)};
    });
    if (!result) throw db.error(fmt::format("no feature_structure {}", id));
    result->blobs = db.values<Id>(
        "SELECT blob FROM feature_structure_blob WHERE feature_structure = ? ORDER BY blob", {sql(id)});
    return *std::move(result);
  });
}

std::vector<FeatureStructureRow> Store::feature_structures(Id scene, const std::string& type) const {
  Where where("scene = ?1", {sql(scene)});
  if (!type.empty()) where.and_also("type = " + where.bind(sql(type)));
  std::vector<FeatureStructureRow> result;
  for (const Id id : connection_->values<Id>(
           fmt::format("SELECT id FROM feature_structure WHERE {} ORDER BY id", where.text()),
           where.values()))
    result.push_back(feature_structure(id));
  return result;
}

std::string Store::type_system(Id id) const {
  const auto content = connection_->value<Id>("SELECT content FROM type_system WHERE id = ?", {sql(id)});
  if (!content) throw error(fmt::format("no type_system {}", id));
  return blob(*content).bytes;
}

std::vector<Store::TableSize> Store::statistics(bool with_bytes) const {
  auto& db = *connection_;
  return db.guarded([&] {
    const std::map<std::string, std::string> owners = table_owners(db);
    std::map<std::string, TableSize> sizes;
    for (const auto& [name, table] : owners) sizes[table].table = table;
    for (auto& [table, size] : sizes)
      size.rows = db.value<int64_t>("SELECT rows FROM row_count WHERE name = ?", {sql(table)}).value_or(-1);
    for (auto& [table, size] : sizes)
      if (size.rows < 0 && has_object(db.format, "table", table))
        size.rows = query_integer(*db.database, "SELECT count(*) FROM " + sql_name(table));
    if (with_bytes) {
      db.query("SELECT name, pgsize FROM dbstat WHERE aggregate = 1", {}, [&](const SqlRow& row) {
        const auto found = owners.find(row.get<std::string>("name"));
        sizes[found == owners.end() ? "sqlite_schema" : found->second].bytes += row.get<int64_t>("pgsize");
      });
      sizes["sqlite_schema"].table = "sqlite_schema";
    }
    std::vector<TableSize> result;
    for (auto& [table, size] : sizes) result.push_back(std::move(size));
    std::ranges::stable_sort(result, std::greater(), &TableSize::bytes);
    return result;
  });
}

std::vector<std::string> Store::view_columns(const std::string& view) const {
  auto& db = *connection_;
  return db.guarded([&] {
    SQLite::Statement rows = all_rows(db, view);
    std::vector<std::string> columns;
    for (int i = 0; i < rows.getColumnCount(); ++i) columns.emplace_back(rows.getColumnName(i));
    return columns;
  });
}

void Store::read_view(const std::string& view, const std::function<void(const Json&)>& visitor) const {
  auto& db = *connection_;
  db.guarded([&] {
    SQLite::Statement rows = all_rows(db, view);
    while (rows.executeStep()) {
      Json row = Json::object();
      for (int i = 0; i < rows.getColumnCount(); ++i) row[rows.getColumnName(i)] = cell_of(rows.getColumn(i));
      visitor(row);
    }
  });
}

namespace {

/// Whether annotations of the type say where an object was in one view: others say what it is.
bool is_about_place(const std::string& type) {
  return std::ranges::any_of(std::array{"Location", "Geometry", "Relation"},
                             [&](const char* word) { return type.find(word) != std::string::npos; });
}

}  // namespace

std::vector<AnnotationSupport> annotation_support(const Store& store,
                                                  const std::vector<ObjectObservation>& observations,
                                                  const AsOf& as_of) {
  std::map<std::pair<std::string, std::string>, size_t> with_value;
  std::map<std::string, size_t> with_type;
  for (const ObjectObservation& observed : observations) {
    std::set<std::pair<std::string, std::string>> values;
    std::set<std::string> types;
    for (const AnnotationRow& row : store.annotations(observed.observation.scene, as_of))
      if (row.observation == observed.observation.id && !row.value.empty() && !is_about_place(row.type)) {
        values.insert({row.type, row.value});
        types.insert(row.type);
      }
    for (const auto& value : values) ++with_value[value];
    for (const auto& type : types) ++with_type[type];
  }
  std::vector<AnnotationSupport> support;
  for (const auto& [key, count] : with_value)
    support.push_back({key.first, key.second, count,
                       static_cast<double>(count) / static_cast<double>(with_type[key.first])});
  std::ranges::stable_sort(support, [](const AnnotationSupport& a, const AnnotationSupport& b) {
    return a.type != b.type ? a.type < b.type : a.observations > b.observations;
  });
  return support;
}

}  // namespace loci::memory
