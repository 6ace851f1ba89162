#include "memory/store/database.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/hash.h"
#include "mapping/base/json.h"

namespace loci::memory {

void add_vector(SqlColumns& columns, const char* prefix, const std::optional<Vector3d>& value) {
  const char* const names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    columns.emplace_back(SqlName(prefix, names[i]), value ? sql((*value)[i]) : SqlValue());
}

void add_pose(SqlColumns& columns, const char* prefix, const std::optional<Isometry3d>& pose) {
  const char* const names[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};
  std::array<double, 7> values{};
  if (pose) values = values_from_pose(*pose);
  for (size_t i = 0; i < 7; ++i)
    columns.emplace_back(SqlName(prefix, names[i]), pose ? sql(values[i]) : SqlValue());
}

void add_color(SqlColumns& columns, const std::optional<HsvColor>& color) {
  columns.emplace_back("hue", color ? sql(color->hue) : SqlValue());
  columns.emplace_back("saturation", color ? sql(color->saturation) : SqlValue());
  columns.emplace_back("value", color ? sql(color->value) : SqlValue());
}

void add_clock(SqlColumns& columns, const Bitemporal& clock) {
  columns.emplace_back("valid_from", sql(clock.valid_from));
  columns.emplace_back("valid_to", sql(clock.valid_to));
  columns.emplace_back("known_from", sql(clock.known_from));
  columns.emplace_back("known_to", sql(clock.known_to));
  columns.emplace_back("supersedes", sql(clock.supersedes));
  columns.emplace_back("run", sql(clock.run));
  columns.emplace_back("source", sql(clock.source));
}

SQLite::Column SqlRow::column(std::string_view name) const {
  const int count = statement_.getColumnCount();
  for (int tried = 0; tried < count; ++tried, ++next_) {
    if (next_ >= count) next_ = 0;
    if (name == statement_.getColumnName(next_)) return statement_.getColumn(next_);
  }
  return statement_.getColumn(std::string(name).c_str());  // which says that there is none
}

std::string SqlRow::bytes(std::string_view name) const {
  const SQLite::Column value = column(name);
  return {static_cast<const char*>(value.getBlob()), static_cast<size_t>(value.getBytes())};
}

std::optional<int64_t> SqlRow::optional_integer(std::string_view name) const {
  return is_null(name) ? std::nullopt : std::optional(integer(name));
}

std::optional<double> SqlRow::optional_real(std::string_view name) const {
  return is_null(name) ? std::nullopt : std::optional(real(name));
}

std::optional<std::string> SqlRow::optional_text(std::string_view name) const {
  return is_null(name) ? std::nullopt : std::optional(text(name));
}

namespace {

/// Numbers of columns that follow each other; unset when one of them is NULL. Each is looked at once.
template <size_t N>
std::optional<std::array<double, N>> numbers_of(const SqlRow& row, std::string_view prefix,
                                                const std::array<const char*, N>& names) {
  std::array<double, N> values{};
  for (size_t i = 0; i < N; ++i) {
    const std::optional<double> value = row.optional_real(std::string(prefix) + names[i]);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

}  // namespace

std::optional<Vector3d> SqlRow::vector(std::string_view prefix) const {
  const auto v = numbers_of<3>(*this, prefix, {"x", "y", "z"});
  return v ? std::optional(Vector3d((*v)[0], (*v)[1], (*v)[2])) : std::nullopt;
}

std::optional<Isometry3d> SqlRow::pose(std::string_view prefix) const {
  const auto values = numbers_of<7>(*this, prefix, {"x", "y", "z", "qx", "qy", "qz", "qw"});
  return values ? std::optional(pose_from_values(*values)) : std::nullopt;
}

std::optional<HsvColor> SqlRow::color() const {
  const auto v = numbers_of<3>(*this, "", {"hue", "saturation", "value"});
  return v ? std::optional(HsvColor{(*v)[0], (*v)[1], (*v)[2]}) : std::nullopt;
}

Bitemporal SqlRow::clock() const {
  Bitemporal clock;
  clock.valid_from = integer("valid_from");
  clock.valid_to = optional_integer("valid_to");
  clock.known_from = integer("known_from");
  clock.known_to = optional_integer("known_to");
  clock.supersedes = optional_integer("supersedes");
  clock.run = integer("run");
  clock.source = text("source");
  return clock;
}

void bind_value(SQLite::Statement& statement, int index, const SqlValue& value) {
  struct Binder {
    SQLite::Statement& statement;
    int index;
    void operator()(std::monostate) const { statement.bind(index); }
    void operator()(int64_t number) const { statement.bind(index, number); }
    void operator()(double number) const { statement.bind(index, number); }
    void operator()(std::string_view text) const { statement.bind(index, std::string(text)); }
    void operator()(BytesView view) const {
      // The bytes outlive the execution, and large ones are not copied for it.
      statement.bindNoCopy(index, static_cast<const void*>(view.bytes.data()),
                           static_cast<int>(view.bytes.size()));
    }
  };
  std::visit(Binder{statement, index}, value);
}

void bind_values(SQLite::Statement& statement, const std::vector<SqlValue>& values) {
  for (size_t i = 0; i < values.size(); ++i) bind_value(statement, static_cast<int>(i) + 1, values[i]);
}

void throw_database_error(const SQLite::Exception& error, const std::filesystem::path& path) {
  const FileLocation place{path.string(), 0, {}};
  switch (error.getErrorCode() & 0xff) {
    case SQLITE_NOTADB:
      throw Error("is no memory of loci, or a damaged one", place, "give a *.loci file");
    case SQLITE_CORRUPT:
      throw Error("the memory is damaged or truncated", place, "restore it from a copy");
    case SQLITE_FULL:
      throw Error("the disk is full", place, "what was committed before is kept; make room and resume");
    case SQLITE_IOERR:  // a limit of the file's size, a quota, a broken disk
      throw Error("the disk does not take or give what it should (" + std::string(error.what()) + ")", place,
                  "what was committed before is kept; make room and resume");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw Error("another program is using this memory", place, "wait until it has finished");
    default:
      throw Error(error.what(), place);
  }
}

SQLite::Statement& Store::Implementation::statement(const std::string& text) {
  auto& slot = statements[text];
  if (!slot) slot = std::make_unique<SQLite::Statement>(*database, text);
  slot->reset();
  slot->clearBindings();
  return *slot;
}

Id Store::Implementation::insert(const char* table, const SqlColumns& columns) {
  // A table's columns always come in the same order, so that its name finds the statement.
  auto& slot = statements[table];
  if (!slot) {
    std::string names, marks;
    for (const auto& [name, value] : columns) {
      names += (names.empty() ? "" : ", ") + std::string(name.prefix) + name.name;
      marks += marks.empty() ? "?" : ", ?";
    }
    slot = std::make_unique<SQLite::Statement>(
        *database, fmt::format("INSERT INTO {} ({}) VALUES ({})", table, names, marks));
  }
  slot->reset();
  int index = 0;
  for (const auto& [name, value] : columns) bind_value(*slot, ++index, value);
  slot->exec();
  ++added[table];
  return database->getLastInsertRowid();
}

void Store::Implementation::add_object_term(Id object, Id term, TimeNs time) {
  constexpr size_t kMaxKept = 20000;
  if (called.size() > kMaxKept) called.clear();
  const auto [known, is_new] = called.try_emplace({object, term}, time);
  if (!is_new && known->second <= time) return;
  known->second = time;
  SQLite::Statement& add = statement(
      "INSERT INTO object_term (term, object, since) VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET since = "
      "excluded.since WHERE excluded.since < since");
  bind_values(add, {sql(term), sql(object), sql(time)});
  add.exec();
}

void Store::Implementation::keep_counts() {
  // As in kCounting; an empty memory has no counts yet.
  constexpr const char* kCounted[] = {
      "scene",  "observation", "annotation",        "blob",      "association", "event",
      "belief", "visibility",  "feature_structure", "scene_log", "reasoning",   "stay"};
  for (const char* table : kCounted) {
    const auto found = added.find(table);
    if (found == added.end()) continue;
    SQLite::Statement& count = statement(
        "INSERT INTO row_count (name, rows) VALUES (?, ?) ON CONFLICT DO UPDATE SET rows = rows + "
        "excluded.rows");
    bind_values(count, {std::string_view(table), sql(found->second)});
    count.exec();
  }
  added.clear();
  just_seen.clear();
}

void Store::Implementation::need_writable() const {
  if (!writable) throw Error("the memory is open for reading only", {path.string(), 0, {}});
}

TimeNs Store::Implementation::known_time() const {
  return options.now.value_or(loci::now());
}

Id Store::Implementation::add_blob(std::string_view bytes, const std::string& media) {
  const std::string hash = content_hash(bytes);
  std::optional<Id> known;
  query("SELECT id FROM blob WHERE hash = ?", {sql(hash)},
        [&](const SqlRow& row) { known = row.integer("id"); });
  if (known) return *known;
  const bool packed = media == "image/jpeg" || media == "image/png";
  const Encoded encoded = packed ? Encoded{0, std::string(bytes)} : encode_bytes(bytes);
  return insert("blob", {{"hash", sql(hash)},
                         {"media", sql(media)},
                         {"size", sql(static_cast<int64_t>(bytes.size()))},
                         {"encoding", sql(encoded.encoding)},
                         {"content", BytesView{encoded.bytes}}});
}

Id Store::Implementation::add_place(const PlaceRow& row, Id run, TimeNs known) {
  std::optional<Id> existing;
  query("SELECT id FROM place WHERE name = ?", {sql(row.name)},
        [&](const SqlRow& r) { existing = r.integer("id"); });
  if (existing) return *existing;
  std::optional<std::string> outline;
  if (!row.outline.empty()) {
    Json points = Json::array();
    for (const Vector2d& point : row.outline) points.push_back({point.x(), point.y()});
    outline = points.dump();
  }
  SqlColumns columns = {
      {"name", sql(row.name)},     {"class", sql(row.class_name)}, {"map", sql(row.map)},
      {"height", sql(row.height)}, {"outline", sql(outline)},      {"container", sql(row.container)},
      {"joint", sql(row.joint)},   {"known_from", sql(known)},     {"run", sql(run)}};
  add_pose(columns, "", row.map_from_place);
  return insert("place", columns);
}

Id Store::Implementation::add_fact(const FactRow& row, Id run, TimeNs known) {
  FactRow stamped = row;
  stamped.clock.known_from = known;
  stamped.clock.run = run;
  SqlColumns columns = {{"object", sql(row.object)},
                        {"place", sql(row.place)},
                        {"key", sql(row.key)},
                        {"value", sql(row.value)},
                        {"probability", sql(row.probability)}};
  add_clock(columns, stamped.clock);
  return insert("fact", columns);
}

Id Store::Implementation::add_term(const std::string& type, const std::string& value) {
  constexpr size_t kMaxKept = 10000;
  if (terms.size() > kMaxKept) terms.clear();
  const auto [slot, fresh] = terms.try_emplace(type + '\n' + value, 0);
  if (!fresh) return slot->second;
  const std::vector<SqlValue> values = {sql(type), sql(value)};
  query("SELECT id FROM term WHERE type = ? AND value = ?", values,
        [&](const SqlRow& row) { slot->second = row.integer("id"); });
  if (slot->second == 0) slot->second = insert("term", {{"type", values[0]}, {"value", values[1]}});
  return slot->second;
}

void Store::Implementation::add_stay(Id belief, const BeliefRow& row, TimeNs from) {
  const int64_t seconds = from / kSecond;
  std::optional<Id> before;
  query(
      "SELECT id FROM belief WHERE object = ? AND valid_from <= ? AND id <> ? ORDER BY valid_from DESC, id "
      "DESC LIMIT 1",
      {sql(row.object), sql(from), sql(belief)}, [&](const SqlRow& found) { before = found.integer("id"); });
  if (before) {
    run("UPDATE stay SET until = ?1 WHERE belief = ?2 AND until > ?1", {sql(seconds), sql(*before)});
  }
  if (!row.position) return;
  int64_t until = kOpenStay;
  query(
      "SELECT valid_from FROM belief WHERE object = ?1 AND valid_from >= ?2 AND (valid_from, id) > (?2, ?3) "
      "ORDER BY valid_from, id LIMIT 1",
      {sql(row.object), sql(from), sql(belief)},
      [&](const SqlRow& found) { until = found.integer("valid_from") / kSecond; });
  const auto millimetre = [&](int axis) {
    return sql(static_cast<int64_t>(std::lround(std::clamp((*row.position)[axis] * 1000, -2e9, 2e9))));
  };
  const SqlValue x = millimetre(0), y = millimetre(1), z = millimetre(2),
                 place = sql((row.status == ObjectStatus::gone ? -1 : 1) * row.place.value_or(0));
  ++added["stay"];
  run("INSERT INTO stay VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      {sql(belief), x, x, y, y, z, z, sql(seconds), sql(until), place, place, sql(row.object)});
}

Encoded encode_bytes(std::string_view bytes) {
  if (bytes.size() < 256) return {0, std::string(bytes)};
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  thread_local const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                                  ZSTD_freeCCtx);
  const size_t size =
      ZSTD_compressCCtx(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size(), 3);
  if (ZSTD_isError(size) != 0 || size > bytes.size() / 20 * 19) return {0, std::string(bytes)};
  packed.resize(size);
  return {1, std::move(packed)};
}

std::string decode_bytes(std::string bytes, int64_t encoding, int64_t size,
                         const std::filesystem::path& path) {
  if (encoding == 0) return bytes;
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  const bool known = stated != ZSTD_CONTENTSIZE_ERROR && stated != ZSTD_CONTENTSIZE_UNKNOWN;
  if (!known || stated > (1ULL << 32) || (size >= 0 && stated != static_cast<unsigned long long>(size)))
    throw Error("a compressed value is damaged", {path.string(), 0, {}}, "restore the memory from a copy");
  std::string plain(static_cast<size_t>(stated), '\0');
  const size_t got = ZSTD_decompress(plain.data(), plain.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(got) != 0 || got != plain.size())
    throw Error("a compressed value is damaged", {path.string(), 0, {}}, "restore the memory from a copy");
  return plain;
}

}  // namespace loci::memory
