#pragma once

// Private to this module: the columns of each table and the fields of its row, stated once for reading and
// writing. In the order of the columns, in which reading finds them at once.

#include <concepts>
#include <deque>

#include "mapping/base/text/json.h"
#include "memory/store/database.h"

namespace loci::memory {

inline constexpr const char* kVectorColumns[] = {"x", "y", "z"};
inline constexpr const char* kPoseColumns[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};
inline constexpr const char* kRoiColumns[] = {"roi_x", "roi_y", "roi_width", "roi_height"};

/// The points of place.outline.
std::vector<Vector2d> outline_from_json(const std::string& text);

/// Fills a row struct from the row at which a query stands. This is where the values of a file are checked:
/// what it passes is finite, fits its type, and can be used as a size, an index or a time. Error for other
/// values.
class RowReader {
 public:
  explicit RowReader(const SqlRow& row) : row_(row) {}

  void id(Id& id) { id = row_.get<Id>("id"); }
  template <class T>
  void operator()(const char* name, T& value) {
    value = row_.get<T>(name);
  }
  /// NULL = a value of its own.
  template <class T>
  void null_as(const T& null, const char* name, T& value) {
    value = row_.get<std::optional<T>>(name).value_or(null);
  }
  void operator()(const char* name, std::vector<Vector2d>& outline);
  void operator()(const char* name, std::map<std::string, double>& numbers);
  void vector(const char* prefix, std::optional<Vector3d>& vector);
  void pose(const char* prefix, std::optional<Isometry3d>& pose);
  void color(std::optional<HsvColor>& color);
  void camera(std::optional<SceneCamera>& camera);
  void roi(std::optional<std::array<int, 4>>& roi);
  void thumbnail_size(int& width, int& height);
  void time(const char* name, TimeNs& time);
  void bitemporal(Bitemporal& times);

 private:
  [[noreturn]] static void refuse(const char* name, const char* what);
  /// Unset when one of them is NULL.
  template <size_t N>
  std::optional<std::array<double, N>> numbers(const char* prefix, const char* const (&names)[N]);

  const SqlRow& row_;
};

/// Collects the columns of a row struct for its table.
class RowWriter {
 public:
  const SqlColumns& columns() const { return columns_; }

  void id(const Id&) {}
  template <class T>
  void operator()(const char* name, const T& value) {
    columns_.emplace_back(name, sql(value));
  }
  template <class T>
  void null_as(const T& null, const char* name, const T& value) {
    columns_.emplace_back(name, value == null ? SqlValue() : sql(value));
  }
  void operator()(const char* name, const std::vector<Vector2d>& outline);
  void operator()(const char* name, const std::map<std::string, double>& numbers);
  void vector(const char* prefix, const std::optional<Vector3d>& vector);
  void pose(const char* prefix, const std::optional<Isometry3d>& pose);
  void color(const std::optional<HsvColor>& color);
  void camera(const std::optional<SceneCamera>& camera);
  void roi(const std::optional<std::array<int, 4>>& roi);
  void thumbnail_size(int width, int height);
  /// Error for what RowReader would refuse: nothing is written that cannot be read again.
  void time(const char* name, TimeNs time);
  void bitemporal(const Bitemporal& times);

 private:
  void json(const char* name, bool empty, const Json& value);

  SqlColumns columns_;
  std::deque<std::string> texts_;  ///< of JSON, to which the columns are views
};

/// A row struct, const when it is written.
template <class Row, class Struct>
concept RowOf = std::same_as<std::remove_const_t<Row>, Struct>;

template <class Columns, RowOf<RunRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("program", row.program);
  column("version", row.version);
  column("configuration", row.configuration);
  column("started", row.started);
  column("finished", row.finished);
}

template <class Columns, RowOf<RecordingRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("fingerprint", row.fingerprint);
  column("name", row.name);
  column("kind", row.kind);
  column("time_assumed", row.time_assumed);
  column("frames", row.frames);
}

template <class Columns, RowOf<MapRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("hash", row.hash);
  column("name", row.name);
  column("urdf", row.urdf);
  column("sidecar", row.sidecar);
}

template <class Columns, RowOf<PlaceRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("name", row.name);
  column("class", row.class_name);
  column("map", row.map);
  column("height", row.height);
  column("outline", row.outline);
  column.pose("", row.map_from_place);
  column("container", row.container);
  column("joint", row.joint);
}

template <class Columns, RowOf<SceneRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("recording", row.recording);
  column("frame_index", row.frame_index);
  column.time("time", row.time);
  column("map", row.map);
  column.camera(row.camera);
  column.pose("", row.map_from_camera);
  column("depth", row.depth);
  column.thumbnail_size(row.depth_width, row.depth_height);
  column("pixel_kinds", row.pixel_kinds);
  column("image", row.image);
  column("joints", row.joints);
  column("known_from", row.known_from);
  column("run", row.run);
}

template <class Columns, RowOf<LogRow> Row>
void visit_columns(Columns& column, Row& row) {
  column("scene", row.scene);
  column("number", row.number);
  column("annotator", row.annotator);
  column("level", row.level);
  column.null_as(std::string(), "text", row.text);
  column("milliseconds", row.milliseconds);
}

template <class Columns, RowOf<ObservationRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("scene", row.scene);
  column("number", row.number);
  column("place", row.place);
  column.vector("", row.position);
  column.pose("box_", row.map_from_box);
  column.vector("size_", row.size);
  column.color(row.hsv);
  column("color", row.color);
  column("points", row.points);
  column("crop", row.crop);
  column("mask", row.mask);
  column.roi(row.roi);
  column("location", row.location);
  column("cloud", row.cloud);
}

/// Only read: what is written is a row of term and one of annotation.
template <class Columns, RowOf<AnnotationRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("scene", row.scene);
  column("observation", row.observation);
  column("type", row.type);
  column("value", row.value);
  column("confidence", row.confidence);
  column("feature_structure", row.feature_structure);
}

template <class Columns, RowOf<ObjectRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column.bitemporal(row.clock);
}

template <class Columns, RowOf<AssociationRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("scene", row.scene);
  column("observation", row.observation);
  column("object", row.object);
  column("explanation", row.explanation);
  column("probability", row.probability);
  column("chosen", row.chosen);
  column.bitemporal(row.clock);
}

template <class Columns, RowOf<EventRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("scene", row.scene);
  column("kind", row.kind);
  column("object", row.object);
  column("observation", row.observation);
  column("place", row.place);
  column("from_place", row.from_place);
  column.vector("", row.position);
  column.vector("from_", row.from_position);
  column("joint", row.joint);
  column("position", row.joint_position);
  column("from_position", row.from_joint_position);
  column("probability", row.probability);
  column("since", row.since);
  column.bitemporal(row.clock);
}

template <class Columns, RowOf<BeliefRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("object", row.object);
  column("scene", row.scene);
  column("status", row.status);
  column("probability", row.probability);
  column("place", row.place);
  column.vector("", row.position);
  column("sigma", row.sigma);
  column("last_scene", row.last_scene);
  column("last_observation", row.last_observation);
  column.color(row.hsv);
  column("color", row.color);
  column.vector("size_", row.size);
  column("fade_s", row.fade_s);
  column("fade_to", row.fade_to);
  column("elsewhere", row.elsewhere);
  column.bitemporal(row.clock);
}

template <class Columns, RowOf<VisibilityRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("scene", row.scene);
  column("object", row.object);
  column("place", row.place);
  column("status", row.status);
  column("probability", row.probability);
  column("fraction", row.fraction);
  column.time("valid_from", row.time);
}

template <class Columns, RowOf<FactRow> Row>
void visit_columns(Columns& column, Row& row) {
  column.id(row.id);
  column("object", row.object);
  column("place", row.place);
  column("key", row.key);
  column("value", row.value);
  column("probability", row.probability);
  column.bitemporal(row.clock);
}

template <class Row>
Row read_row(const SqlRow& from) {
  Row row;
  RowReader reader(from);
  visit_columns(reader, row);
  if constexpr (std::is_same_v<Row, BeliefRow>) {
    row.probability_then = row.probability;
    row.then = row.clock.valid_from;
  }
  return row;
}

/// Adds a row, with columns that are not fields of it.
template <class Row>
Id insert_row(Store::Connection& db, const Row& row, const SqlColumns& more = {}) {
  RowWriter writer;
  visit_columns(writer, row);
  SqlColumns columns = writer.columns();
  columns.insert(columns.end(), more.begin(), more.end());
  return db.insert(Row::kTable, columns);
}

/// The rows of SELECT * FROM `from` WHERE `where` ORDER BY `order`.
template <class Row>
std::vector<Row> select(Store::Connection& db, const std::string& from, const Where& where,
                        const std::string& order = "id") {
  return db.guarded([&] {
    std::vector<Row> rows;
    db.query(fmt::format("SELECT * FROM {} WHERE {} ORDER BY {}", from, where.text(), order), where.values(),
             [&](const SqlRow& row) { rows.push_back(read_row<Row>(row)); });
    return rows;
  });
}
template <class Row>
std::vector<Row> select(Store::Connection& db, const Where& where = Where(),
                        const std::string& order = "id") {
  return select<Row>(db, Row::kTable, where, order);
}
/// The first of them; unset when there are none.
template <class Row>
std::optional<Row> select_first(Store::Connection& db, const std::string& from, const Where& where,
                                const std::string& order = "id") {
  auto rows = select<Row>(db, from, where, order + " LIMIT 1");
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}
template <class Row>
std::optional<Row> select_first(Store::Connection& db, const Where& where, const std::string& order = "id") {
  return select_first<Row>(db, Row::kTable, where, order);
}
template <class Row>
Row select_by_id(Store::Connection& db, Id id) {
  auto row = select_first<Row>(db, Row::kTable, Where("id = ?1", {sql(id)}));
  if (!row) throw db.error(fmt::format("no {} {}", Row::kTable, id));
  return *std::move(row);
}

}  // namespace loci::memory
