#include "memory/store/database.h"

#include <sqlite3.h>
#include <unistd.h>
#include <zstd.h>

#include "mapping/base/text/hash.h"
#include "memory/store/memory_file.h"
#include "memory/store/rows/digest.h"
#include "memory/store/rows/row_columns.h"
#include "memory/store/rows/schema_check.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {

namespace {

namespace fs = std::filesystem;

/// More is not believed of one value, however small it is when compressed.
constexpr uint64_t kMaxValueBytes = uint64_t{1} << 28;

}  // namespace

void SqlRow::refuse_value(const SQLite::Column& value) {
  throw Error(fmt::format("{} holds a number that is out of range", value.getName()), {},
              "loci-memory verify lists what is damaged");
}

std::unique_ptr<SQLite::Database> open_database(const std::string& name, int flags) {
  // Statistics of its memory would make every allocation wait for those of all threads. A connection is of
  // one thread at a time, and needs no lock for each value.
  [[maybe_unused]] static const int configured = sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0);
  auto database = std::make_unique<SQLite::Database>(name, flags | SQLITE_OPEN_NOMUTEX);
  sqlite3_db_config(database->getHandle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database->getHandle(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  database->setBusyTimeout(5000);
  database->exec("PRAGMA cell_size_check = ON");
  return database;
}

void trust_schema(SQLite::Database& database) {
  sqlite3_db_config(database.getHandle(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 1, nullptr);
}

bool can_write(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return ::access(path.c_str(), W_OK) == 0 && ::access(folder.c_str(), W_OK) == 0;
}

std::unique_ptr<SQLite::Database> open_database_to_read(const fs::path& path) {
  // Opened so that the shared memory of the log can be set up and removed again; query_only prevents the
  // rest.
  if (can_write(path)) return open_database(path.string(), SQLite::OPEN_READWRITE);
  std::error_code ignored;
  const fs::path log = path.string() + "-wal";
  if (fs::exists(log, ignored) && fs::file_size(log, ignored) > 0)
    return open_database(path.string(), SQLite::OPEN_READONLY);
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string())
    uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", static_cast<unsigned char>(c))
                                            : std::string(1, c);
  return open_database(uri + "?immutable=1", SQLite::OPEN_READONLY | SQLite::OPEN_URI);
}

SQLite::Column SqlRow::column(std::string_view name) const {
  if (names_.empty())
    for (int i = 0; i < statement_.getColumnCount(); ++i) names_.emplace_back(statement_.getColumnName(i));
  for (size_t tried = 0; tried < names_.size(); ++tried, ++next_) {
    if (next_ >= names_.size()) next_ = 0;
    if (name == names_[next_]) return statement_.getColumn(static_cast<int>(next_));
  }
  return statement_.getColumn(std::string(name).c_str());  // throws: there is none
}

std::string SqlRow::bytes(std::string_view name) const {
  const SQLite::Column value = column(name);
  return {static_cast<const char*>(value.getBlob()), static_cast<size_t>(value.getBytes())};
}

Where& Where::known(const AsOf& as_of) {
  if (!as_of.known_at) return and_also("known_to IS NULL");
  return and_also(
      fmt::format("known_from <= {0} AND (known_to IS NULL OR known_to > {0})", bind(sql(*as_of.known_at))));
}

Where& Where::begun(const AsOf& as_of) {
  return between("valid_from", {}, as_of.at);
}

Where& Where::holds(const AsOf& as_of) {
  if (!as_of.at) return and_also("valid_to IS NULL");
  return and_also(
      fmt::format("valid_from <= {0} AND (valid_to IS NULL OR valid_to > {0})", bind(sql(*as_of.at))));
}

Where& Where::added(const char* column, const AsOf& as_of) {
  return between(column, {}, as_of.at).between("known_from", {}, as_of.known_at);
}

Where& Where::newest_visibility(const AsOf& as_of) {
  const std::string known =
      as_of.known_at ? fmt::format(" AND later.known_from <= {}", bind(sql(*as_of.known_at))) : "";
  return and_also(
      fmt::format("(object IS NULL OR NOT EXISTS (SELECT 1 FROM visibility later WHERE later.scene = "
                  "visibility.scene AND later.object = visibility.object AND later.id > visibility.id{}))",
                  known));
}

std::string Where::label_holds(const AsOf& as_of) {
  // Annotations have no transaction time: the runs of the edits that added labels have it.
  const std::string later =
      as_of.known_at ? fmt::format(
                           "(SELECT count(*) FROM run r WHERE r.program LIKE '{}%' AND r.started > {} AND "
                           "json_valid(r.configuration) AND json_extract(r.configuration, "
                           "'$.label.observation') = n.observation)",
                           kEditProgram, bind(sql(*as_of.known_at)))
                     : "0";
  return fmt::format(
      "(n.term NOT IN (SELECT id FROM term WHERE type = '{0}') OR (n.term NOT IN (SELECT id FROM term WHERE "
      "type = '{0}' AND value = '') AND {1} = (SELECT count(*) FROM annotation l JOIN term lt ON lt.id = "
      "l.term WHERE l.scene = n.scene AND l.observation = n.observation AND lt.type = '{0}' AND l.id > "
      "n.id)))",
      kLabelType, later);
}

Where& Where::between(const char* column, std::optional<TimeNs> from, std::optional<TimeNs> to) {
  if (from) and_also(fmt::format("{} >= {}", column, bind(sql(*from))));
  if (to) and_also(fmt::format("{} <= {}", column, bind(sql(*to))));
  return *this;
}

Where& Where::and_also(const std::string& condition) {
  text_ += " AND " + condition;
  return *this;
}

std::string Where::bind(SqlValue value) {
  values_.push_back(value);
  return fmt::format("?{}", values_.size());
}

void bind_values(SQLite::Statement& statement, const SqlValues& values) {
  struct Binder {
    SQLite::Statement& statement;
    int index;
    void operator()(std::monostate) const { statement.bind(index); }
    void operator()(int64_t number) const { statement.bind(index, number); }
    void operator()(double number) const { statement.bind(index, number); }
    void operator()(std::string_view text) const { statement.bind(index, std::string(text)); }
    void operator()(BytesView view) const {  // large ones are not copied
      statement.bindNoCopy(index, static_cast<const void*>(view.bytes.data()),
                           static_cast<int>(view.bytes.size()));
    }
  };
  int index = 0;
  for (const SqlValue& value : values) std::visit(Binder{statement, ++index}, value);
}

int64_t run_statements(SQLite::Database& database, const std::string& text, const SqlValues& values) {
  int64_t changed = 0;
  for (size_t begin = 0, end = 0; (end = text.find(';', begin)) != std::string::npos; begin = end + 1) {
    SQLite::Statement statement(database, text.substr(begin, end - begin + 1));
    const auto count = static_cast<std::ptrdiff_t>(
        std::min(static_cast<size_t>(statement.getBindParameterCount()), values.size()));
    bind_values(statement, {values.begin(), values.begin() + count});
    changed += statement.exec();
  }
  return changed;
}

int64_t query_integer(SQLite::Database& database, const std::string& text) {
  return database.execAndGet(text).getInt64();
}

void throw_database_error(const SQLite::Exception& error, const std::filesystem::path& path) {
  std::string what = error.what(), hint;
  switch (error.getErrorCode() & 0xff) {
    case SQLITE_NOTADB:
      what = "is not a memory of loci, or a damaged one";
      hint = "give a *.loci file";
      break;
    case SQLITE_CORRUPT:
      what = "the memory is damaged or truncated";
      hint = "restore it from a copy";
      break;
    case SQLITE_FULL:
      what = "the disk is full";
      hint = kMakeRoom;
      break;
    case SQLITE_IOERR:  // a limit of the file size, a quota, a broken disk
      what = fmt::format("the disk cannot be read or written ({})", error.what());
      hint = kMakeRoom;
      break;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      what = "another program is using this memory";
      hint = "wait until it has finished";
      break;
  }
  throw Error(what, {path.string(), 0, {}}, hint);
}

SQLite::Statement& Store::Connection::statement(const std::string& text) {
  auto found = statements.find(text);
  if (found == statements.end())  // built first: a damaged file may not let it be prepared
    found = statements.emplace(text, std::make_unique<SQLite::Statement>(*database, text)).first;
  found->second->reset();
  found->second->clearBindings();
  return *found->second;
}

void Store::Connection::run(const std::string& text, const SqlValues& values) {
  SQLite::Statement& prepared = statement(text);
  bind_values(prepared, values);
  prepared.exec();
}

Id Store::Connection::insert(const char* table, const SqlColumns& columns) {
  // The columns of a table always come in the same order, so that its name finds the statement.
  auto found = statements.find(table);
  if (found == statements.end()) {
    std::string names, marks;
    for (const auto& [name, value] : columns) {
      names += (names.empty() ? "" : ", ") + sql_name(std::string(name.prefix) + name.name);
      marks += marks.empty() ? "?" : ", ?";
    }
    const std::string text = fmt::format("INSERT INTO {} ({}) VALUES ({})", table, names, marks);
    found = statements.emplace(table, std::make_unique<SQLite::Statement>(*database, text)).first;
  }
  SQLite::Statement& prepared = *found->second;
  prepared.reset();
  SqlValues values;
  for (const auto& [name, value] : columns) values.push_back(value);
  bind_values(prepared, values);
  prepared.exec();
  const Id id = database->getLastInsertRowid();
  ++added[table];
  digests[table] += row_digest(table, columns, id);
  return id;
}

void Store::Connection::begin() {
  database->exec(open_transactions == 0 ? "BEGIN IMMEDIATE" : "SAVEPOINT inner");
  ++open_transactions;
  added.clear();
  digests.clear();
}

void Store::Connection::commit() {
  save_counts();
  database->exec(open_transactions == 1 ? "COMMIT" : "RELEASE inner");
  --open_transactions;
}

void Store::Connection::roll_back() noexcept {
  for (auto& [text, statement] : statements) statement->tryReset();
  clear_caches();
  database->tryExec(open_transactions == 1 ? "ROLLBACK" : "ROLLBACK TO inner; RELEASE inner");
  --open_transactions;
}

bool Store::Connection::needs_known(const AsOf& as_of) {
  if (as_of.known_at) return true;
  if (superseded) return *superseded;
  const bool found =
      value<int64_t>("SELECT 1 FROM association WHERE supersedes IS NOT NULL LIMIT 1").has_value();
  if (read_transactions > 0) superseded = found;
  return found;
}

void Store::Connection::require_writable() const {
  if (!writable) throw error("the memory is open for reading only");
}

Id Store::Connection::next_object_id() {
  return *value<Id>(kNextObject);
}

Id Store::Connection::add_blob(std::string_view bytes, const std::string& media) {
  const std::string hash = content_hash(bytes);
  if (const auto known = value<Id>("SELECT id FROM blob WHERE hash = ?", {sql(hash)})) return *known;
  if (bytes.size() > kMaxValueBytes)
    throw error(fmt::format("{} MB are too much for one value", bytes.size() >> 20),
                "up to 256 MB are stored");
  const bool packed = media == "image/jpeg" || media == "image/png";
  const Encoded encoded = packed ? Encoded{0, std::string(bytes)} : encode_bytes(bytes);
  return insert("blob", {{"hash", sql(hash)},
                         {"media", sql(media)},
                         {"size", sql(static_cast<int64_t>(bytes.size()))},
                         {"encoding", sql(encoded.encoding)},
                         {"content", BytesView{encoded.bytes}}});
}

Id Store::Connection::add_place(const PlaceRow& row, Id run, TimeNs known) {
  if (const auto existing = value<Id>("SELECT id FROM place WHERE name = ?", {sql(row.name)}))
    return *existing;
  return insert_row(*this, row, {{"known_from", sql(known)}, {"run", sql(run)}});
}

Id Store::Connection::add_fact(const FactRow& row, Id run, TimeNs known) {
  FactRow stamped = row;
  stamped.clock.known_from = known;
  stamped.clock.run = run;
  return insert_row(*this, stamped);
}

Id Store::Connection::add_term(const std::string& type, const std::string& value) {
  constexpr size_t kMaxCached = 10000;
  if (terms.size() > kMaxCached) terms.clear();
  const auto [slot, is_new] = terms.try_emplace(type + '\n' + value, 0);
  if (!is_new) return slot->second;
  const SqlValues values = {sql(type), sql(value)};
  const auto known = this->value<Id>("SELECT id FROM term WHERE type = ? AND value = ?", values);
  return slot->second = known ? *known : insert("term", {{"type", values[0]}, {"value", values[1]}});
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
  const Error damaged("a stored value is damaged", {path.string(), 0, {}}, "restore the memory from a copy");
  if (encoding == 0 && (size < 0 || static_cast<uint64_t>(size) == bytes.size())) return bytes;
  if (encoding != 1) throw damaged;
  const unsigned long long stated = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  const bool known = stated != ZSTD_CONTENTSIZE_ERROR && stated != ZSTD_CONTENTSIZE_UNKNOWN;
  if (!known || stated > kMaxValueBytes || (size >= 0 && stated != static_cast<unsigned long long>(size)))
    throw damaged;
  std::string plain(static_cast<size_t>(stated), '\0');
  const size_t got = ZSTD_decompress(plain.data(), plain.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(got) != 0 || got != plain.size()) throw damaged;
  return plain;
}

}  // namespace loci::memory
