// Opening and closing of a memory, its format, and rows that belong to no scene.

#include "memory/store/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <cstring>

#include "mapping/base/hash.h"
#include "memory/store/derived_rows.h"
#include "memory/store/format.h"
#include "memory/store/memory_file.h"
#include "memory/store/row_columns.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

Error file_error(const fs::path& path, const std::string& what, const std::string& hint = {}) {
  return Error(what, {path.string(), 0, {}}, hint);
}

fs::path lock_path(const fs::path& path) {
  return path.string() + ".lock";
}

/// Keeps other writers out. The lock is a file of its own, because closing another descriptor of the database
/// file would release SQLite's own locks. It is released with its process.
int take_lock(const fs::path& path) {
  const fs::path name = lock_path(path);
  for (int attempt = 0; attempt < 10; ++attempt) {
    const int descriptor = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0) throw file_error(path, std::string("cannot be written: ") + std::strerror(errno));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      ::close(descriptor);
      throw file_error(path, "another program is writing to this memory",
                       "wait until it has finished; reading is possible meanwhile");
    }
    // Between open and flock the last writer may have removed the name.
    struct stat mine {
    }, named{};
    if (::fstat(descriptor, &mine) == 0 && ::stat(name.c_str(), &named) == 0 && mine.st_ino == named.st_ino)
      return descriptor;
    ::close(descriptor);
  }
  throw file_error(path, "another program is writing to this memory", "try again");
}

bool is_blank(SQLite::Database& database) {
  return query_integer(database, "PRAGMA application_id") == 0 &&
         query_integer(database, "SELECT count(*) FROM sqlite_master") == 0;
}

std::string version_text(int version) {
  return fmt::format("{}.{}", version / 1000, version % 1000);
}

/// The program that reads a file of a newer major version.
std::string program_for(SQLite::Database& database, int version) {
  try {
    return database.execAndGet("SELECT value FROM meta WHERE key = 'written_by'").getString() + " or later";
  } catch (const SQLite::Exception&) {
    return fmt::format("loci {}.0 or later", version / 1000);
  }
}

/// The version of the file. Error when this program cannot read it.
int check_version(SQLite::Database& database, const fs::path& path, const MemoryFormat& format) {
  const int64_t application = query_integer(database, "PRAGMA application_id");
  if (application == kDevelopmentApplicationId)
    throw file_error(path, "was written by a development version of loci",
                     "run loci-perceive again on the recording");
  if (application != kMemoryApplicationId)
    throw file_error(path, "is an SQLite database, but not a memory of loci", "give a *.loci file");
  const auto version = static_cast<int>(query_integer(database, "PRAGMA user_version"));
  if (version / 1000 > format.major())
    throw file_error(path,
                     fmt::format("has memory format {}, this program reads up to {}.x", version_text(version),
                                 format.major()),
                     "read it with " + program_for(database, version));
  if (version < 1000) throw file_error(path, "has no memory format version", "the file is damaged");
  return version;
}

void check_writable_version(int version, const fs::path& path, const MemoryFormat& format) {
  if (version > format.version)
    throw file_error(path,
                     fmt::format("has memory format {}, newer than this program's {}: it can only be read",
                                 version_text(version), version_text(format.version)),
                     "write to it with a newer loci");
}

void migrate(SQLite::Database& database, int version, const MemoryFormat& format) {
  if (version >= format.version) return;
  SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
  for (const Migration& migration : format.migrations)
    if (migration.version > version) database.exec(migration.sql);
  derive_tables(database);
  database.exec(fmt::format("PRAGMA user_version = {}", format.version));
  all.commit();
}

void create_schema(SQLite::Database& database, TimeNs known, const MemoryFormat& format) {
  SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
  database.exec(format.schema);
  database.exec(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kMemoryApplicationId,
                            format.version));
  SQLite::Statement meta(database, "INSERT INTO meta (key, value) VALUES (?, ?)");
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"format", "loci-memory"},
                                   {"created", format_time(known)},
                                   {"written_by", "loci " LOCI_VERSION}}) {
    meta.bind(1, key);
    meta.bind(2, value);
    meta.exec();
    meta.reset();
  }
  count_rows(database);
  all.commit();
}

void configure(SQLite::Database& database) {
  database.setBusyTimeout(5000);
  database.exec(
      "PRAGMA cache_size = -16000");  // 16 MB: what scenes change and questions read again and again
  database.exec("PRAGMA foreign_keys = ON");
}

/// A memory without scenes; complete or not there at all, whenever the program is stopped.
void create_memory(const fs::path& path, TimeNs known, const MemoryFormat& format) {
  const fs::path partial = path.string() + ".partial";
  std::error_code ignored;
  for (const char* end : {"", "-wal", "-shm", "-journal"}) fs::remove(partial.string() + end, ignored);
  {
    SQLite::Database database(partial.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    configure(database);
    create_schema(database, known, format);
    database.exec("PRAGMA journal_mode = WAL");
  }
  fs::rename(partial, path);
}

bool can_write(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return ::access(path.c_str(), W_OK) == 0 && ::access(folder.c_str(), W_OK) == 0;
}

/// A file in a folder where nothing can be written (a read-only medium) is opened as immutable.
std::unique_ptr<SQLite::Database> open_database_to_read(const fs::path& path) {
  // Opened so that the shared memory of the log can be set up and removed again; query_only prevents the
  // rest.
  if (can_write(path)) return std::make_unique<SQLite::Database>(path.string(), SQLite::OPEN_READWRITE);
  std::error_code ignored;
  const fs::path log = path.string() + "-wal";
  if (fs::exists(log, ignored) && fs::file_size(log, ignored) > 0)
    return std::make_unique<SQLite::Database>(path.string(), SQLite::OPEN_READONLY);
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string())
    uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", static_cast<unsigned char>(c))
                                            : std::string(1, c);
  return std::make_unique<SQLite::Database>(uri + "?immutable=1", SQLite::OPEN_READONLY | SQLite::OPEN_URI);
}

}  // namespace

Store::Connection::~Connection() {
  statements.clear();
  if (writable && database) {
    try {
      database->exec("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const SQLite::Exception&) {
      // The log stays beside the file; the next program that opens the memory takes it over.
    }
  }
  database.reset();
  if (lock >= 0) {
    ::unlink(lock_path(path).c_str());
    ::close(lock);
  }
}

Store Store::open_read(const fs::path& path, const MemoryFormat& format) {
  std::error_code code;
  if (!fs::exists(path, code)) throw file_error(path, "no such memory", "loci-perceive run makes one");
  if (fs::is_directory(path, code)) throw file_error(path, "is a folder, a memory file was expected");
  auto connection = std::make_unique<Connection>();
  connection->path = path;
  connection->guarded([&] {
    connection->database = open_database_to_read(path);
    SQLite::Database& database = *connection->database;
    configure(database);
    database.exec("PRAGMA cache_size = -64000");  // Questions read back and forth in a long history.
    if (is_blank(database)) throw file_error(path, "is empty, not a memory of loci", "give a *.loci file");
    connection->version = check_version(database, path, format);
    for (const Migration& migration : format.migrations)
      if (migration.version > connection->version) database.exec(migration.read_views);
    if (can_write(path)) database.exec("PRAGMA query_only = ON");
  });
  return Store(std::move(connection));
}

Store Store::open_write(const fs::path& path, const WriteOptions& options, const MemoryFormat& format) {
  std::error_code code;
  if (fs::is_directory(path, code)) throw file_error(path, "is a folder, a memory file was expected");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code)) throw file_error(path, "the folder does not exist");
  auto connection = std::make_unique<Connection>();
  connection->path = path;
  connection->now = options.now;
  connection->lock = take_lock(path);
  const bool existed = fs::exists(path, code);
  // What a program that was killed while it rewrote the memory left: it may hold what was to be forgotten.
  { const TemporaryMemory unfinished(path.string() + ".partial"); }
  try {
    connection->guarded([&] {
      if (!existed) create_memory(path, connection->known_time(), format);
      connection->database = std::make_unique<SQLite::Database>(path.string(), SQLite::OPEN_READWRITE);
      SQLite::Database& database = *connection->database;
      configure(database);
      if (is_blank(database)) create_schema(database, connection->known_time(), format);
      const int version = check_version(database, path, format);
      check_writable_version(version, path, format);
      migrate(database, version, format);
      database.exec("PRAGMA journal_mode = WAL");
      database.exec("PRAGMA synchronous = NORMAL");
      // The same pages change with every scene: a log of eight times the usual size writes each less often.
      database.exec("PRAGMA wal_autocheckpoint = 8000");
      database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
      connection->version = format.version;
    });
  } catch (...) {
    if (!existed) {
      connection->database.reset();
      for (const char* end : {"", ".partial"}) fs::remove(path.string() + end, code);
    }
    throw;
  }
  connection->writable = true;
  return Store(std::move(connection));
}

Store::Store(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

Store::ReadTransaction::ReadTransaction(const Store& store) : db_(*store.connection_) {
  if (db_.writable || db_.read_transactions++ > 0) return;
  try {
    db_.guarded([&] { db_.database->exec("BEGIN"); });
  } catch (...) {
    --db_.read_transactions;
    throw;
  }
}

Store::ReadTransaction::~ReadTransaction() {
  if (db_.writable || --db_.read_transactions > 0) return;
  for (auto& [text, statement] : db_.statements) statement->tryReset();
  db_.database->tryExec("COMMIT");
}

const fs::path& Store::path() const {
  return connection_->path;
}
bool Store::writable() const {
  return connection_->writable;
}
int Store::major() const {
  return connection_->version / 1000;
}
int Store::minor() const {
  return connection_->version % 1000;
}
Error Store::error(const std::string& what, const std::string& hint) const {
  return connection_->error(what, hint);
}

Id Store::begin_run(const std::string& program, const std::string& configuration_json) {
  auto& db = *connection_;
  return db.transaction([&] {
    return insert_row(db, RunRow{.program = program,
                                 .version = LOCI_VERSION,
                                 .configuration = configuration_json,
                                 .started = db.known_time()});
  });
}

void Store::finish_run(Id run) {
  auto& db = *connection_;
  db.transaction([&] {
    db.run("UPDATE run SET finished = ? WHERE id = ?", {sql(db.known_time()), sql(run)});
  });
}

Id Store::add_recording(const RecordingRow& row) {
  auto& db = *connection_;
  if (const auto existing = recording(row.fingerprint)) return existing->id;
  return db.transaction([&] { return insert_row(db, row); });
}

Id Store::add_map(const std::string& name, std::string_view urdf, std::string_view sidecar) {
  auto& db = *connection_;
  MapRow row{.hash = content_hash(content_hash(urdf) + content_hash(sidecar)), .name = name};
  return db.transaction([&] {
    if (const auto existing = db.value<Id>("SELECT id FROM map WHERE hash = ?", {sql(row.hash)}))
      return *existing;
    row.urdf = db.add_blob(urdf, "application/xml");
    if (!sidecar.empty()) row.sidecar = db.add_blob(sidecar, "application/json");
    return insert_row(db, row);
  });
}

Id Store::add_place(const PlaceRow& row, Id run) {
  auto& db = *connection_;
  return db.transaction([&] { return db.add_place(row, run, db.known_time()); });
}

Id Store::add_fact(const FactRow& row, Id run) {
  auto& db = *connection_;
  return db.transaction([&] { return db.add_fact(row, run, db.known_time()); });
}

void Store::set_meta(const std::string& key, const std::string& value) {
  auto& db = *connection_;
  db.transaction([&] {
    db.run("INSERT OR REPLACE INTO meta (key, value) VALUES (?, ?)", {sql(key), sql(value)});
  });
}

std::string object_name(Id object) {
  return fmt::format("object_{}", object);
}

std::optional<Id> object_id(std::string_view name) {
  constexpr std::string_view prefix = "object_";
  if (!name.starts_with(prefix) || name.size() == prefix.size()) return std::nullopt;
  Id id = 0;
  const char* end = name.data() + name.size();
  const auto result = std::from_chars(name.data() + prefix.size(), end, id);
  if (result.ec != std::errc() || result.ptr != end || id < 1) return std::nullopt;
  return id;
}

}  // namespace loci::memory
