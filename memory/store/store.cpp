// Opening and closing of a memory, its format, and rows that belong to no scene.

#include "memory/store/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "mapping/base/files.h"
#include "mapping/base/text/hash.h"
#include "mapping/base/text/text.h"
#include "memory/store/format.h"
#include "memory/store/memory_file.h"
#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/digest.h"
#include "memory/store/rows/row_columns.h"
#include "memory/store/rows/schema_check.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

Error file_error(const fs::path& path, const std::string& what, const std::string& hint = {}) {
  return Error(what, {path.string(), 0, {}}, hint);
}

/// Keeps other writers out. The lock is a file of its own, because closing another descriptor of the database
/// file would release SQLite's own locks. It lies beside the file that symbolic links lead to, and is
/// released with its process.
int take_lock(const fs::path& name, const fs::path& path) {
  for (int attempt = 0; attempt < 10; ++attempt) {
    const int descriptor = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
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

/// Log and lock go by the name of the file: under a second name, a second writer would know of neither.
void check_only_name(const fs::path& path) {
  const auto names = fs::hard_link_count(path);
  if (names > 1)
    throw file_error(
        path, fmt::format("has {} names (hard links): writing under one of them would damage it", names),
        "remove the other names, or write to a copy (loci-memory backup)");
}

// What people typed stays out of the text of a corrected map; its hash is that of its own bytes.
constexpr std::string_view kCorrection = "<!-- correction of ";

/// The hash of the map that a text corrects; empty for others.
std::string corrected_map(const std::string& urdf) {
  const size_t at = urdf.rfind(kCorrection);
  if (at == std::string::npos) return "";
  const size_t begin = at + kCorrection.size();
  return urdf.substr(begin, urdf.find(' ', begin) - begin);
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

/// A copy of a memory before its migration: memory.loci.1.0, memory.loci.1.0.2, ...
fs::path backup_beside(const fs::path& path, int version) {
  const std::string name = path.string() + "." + version_text(version);
  fs::path kept = name;
  std::error_code none;
  for (int n = 2; fs::exists(kept, none); ++n) kept = fmt::format("{}.{}", name, n);
  create_atomically(kept, {path}, [&](const fs::path& made) { copy_database(path, made); });
  return kept;
}

/// Migrates a memory of an older minor version. As it was it may be kept beside: the path of that copy.
fs::path migrate(SQLite::Database& database, const fs::path& path, int version, bool keep,
                 const MemoryFormat& format) {
  if (version >= format.version) return {};
  fs::path kept = keep ? backup_beside(path, version) : fs::path();
  SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
  for (const Migration& migration : format.migrations)
    if (migration.version > version) database.exec(migration.sql);
  derive_tables(database);
  database.exec(fmt::format("PRAGMA user_version = {}", format.version));
  check_schema(database, path, format.version, format);
  all.commit();
  return kept;
}

void create_schema(SQLite::Database& database, TimeNs known, const std::string& time_zone,
                   const MemoryFormat& format) {
  SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
  database.exec(format.schema);
  database.exec(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kMemoryApplicationId,
                            format.version));
  SQLite::Statement meta(database, "INSERT INTO meta (key, value) VALUES (?, ?)");
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"format", "loci-memory"},
                                   {"created", format_time(known)},
                                   {"written_by", "loci " LOCI_VERSION},
                                   {"time_zone", time_zone}}) {
    meta.bind(1, key);
    meta.bind(2, value);
    meta.exec();
    meta.reset();
  }
  count_rows(database);
  all.commit();
}

/// The last transaction time. Of rows that are added without an order of time, the last one that was added.
TimeNs last_transaction(SQLite::Database& database) {
  std::string times = "SELECT max(started) AS time FROM run UNION ALL SELECT max(finished) FROM run";
  for (const char* table : {"scene", "association", "event", "belief", "fact"})
    times += fmt::format(" UNION ALL SELECT known_from FROM {0} WHERE id = (SELECT max(id) FROM {0})", table);
  return query_integer(database, "SELECT max(time) FROM (" + times + ")");
}

void configure(SQLite::Database& database) {
  database.exec(
      "PRAGMA cache_size = -16000");  // 16 MB: what scenes change and questions read again and again
  database.exec("PRAGMA foreign_keys = ON");
}

/// A memory without scenes; complete or not there at all, whenever the program is stopped.
void create_memory(const fs::path& path, TimeNs known, const std::string& time_zone,
                   const MemoryFormat& format) {
  create_atomically(path, {}, [&](const fs::path& made) {
    const auto database = open_database(made.string(), SQLite::OPEN_READWRITE);
    configure(*database);
    create_schema(*database, known, time_zone, format);
    database->exec("PRAGMA journal_mode = WAL");
  });
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
    ::unlink(lock_name.c_str());
    ::close(lock);
  }
}

Store Store::open_read(const fs::path& path, const MemoryFormat& format) {
  std::error_code code;
  if (!fs::exists(path, code))
    throw file_error(path, "no such memory",
                     path.string().find(":/") == std::string::npos ? "loci-perceive run makes one"
                                                                   : "this needs a file, not a database");
  if (fs::is_directory(path, code)) throw file_error(path, "is a folder, a memory file was expected");
  auto connection = std::make_unique<Connection>();
  connection->path = path;
  if (const fs::path origin = path.string() + kReplicaOf; fs::exists(origin, code))
    connection->replica_of = trimmed(read_file(origin));
  connection->format = format;
  connection->guarded([&] {
    connection->database = open_database_to_read(path);
    SQLite::Database& database = *connection->database;
    configure(database);
    database.exec("PRAGMA cache_size = -64000");  // Questions read back and forth in a long history.
    if (is_blank(database)) throw file_error(path, "is empty, not a memory of loci", "give a *.loci file");
    connection->version = check_version(database, path, format);
    check_schema(database, path, connection->version, format);
    if (connection->version > format.version) shadow_views(database, format);
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
  const std::string time_zone = options.time_zone.empty() ? "UTC" : TimeZone::named(options.time_zone).name();
  auto connection = std::make_unique<Connection>();
  connection->path = path;
  connection->format = format;
  connection->now = options.now;
  connection->lock_name = fs::weakly_canonical(path).string() + ".lock";
  connection->lock = take_lock(connection->lock_name, path);
  // What a program that was killed while it rewrote the memory left: it may hold what was to be forgotten.
  { const PartialMemory unfinished(path); }
  connection->guarded([&] {
    refuse_foreign_side_files(path);
    if (!fs::exists(path, code)) create_memory(path, connection->known_time(), time_zone, format);
    check_only_name(path);
    connection->database = open_database(path.string(), SQLite::OPEN_READWRITE);
    SQLite::Database& database = *connection->database;
    configure(database);
    if (is_blank(database)) create_schema(database, connection->known_time(), time_zone, format);
    const int version = check_version(database, path, format);
    check_writable_version(version, path, format);
    check_schema(database, path, version, format);
    trust_schema(database);
    connection->kept_before_migration =
        migrate(database, path, version, options.keep_before_migration, format);
    if (!connection->value<int64_t>("SELECT 1 FROM meta WHERE key = 'digests'")) {
      SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
      derive_digests(database);  // of a program that did not keep them yet
      all.commit();
    }
    database.exec("PRAGMA journal_mode = WAL");
    database.exec("PRAGMA synchronous = NORMAL");
    // The same pages change with every scene: a log of eight times the usual size writes each less often.
    database.exec("PRAGMA wal_autocheckpoint = 8000");
    database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
    connection->last_known = last_transaction(database);
    connection->version = format.version;
  });
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
  db_.superseded.reset();
  for (auto& [text, statement] : db_.statements) statement->tryReset();
  db_.database->tryExec("COMMIT");
}

const fs::path& Store::path() const {
  return connection_->path;
}
std::string Store::name() const {
  return connection_->name();
}
const fs::path& Store::kept_before_migration() const {
  return connection_->kept_before_migration;
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
    const auto digest = [&] {
      SQLite::Statement row(*db.database, "SELECT * FROM run WHERE id = ?");
      row.bind(1, run);
      return row.executeStep() ? row_digest(RunRow::kTable, row) : 0;
    };
    const uint64_t before = digest();
    db.run("UPDATE run SET finished = ? WHERE id = ?", {sql(db.known_time()), sql(run)});
    db.digests[RunRow::kTable] += digest() - before;
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

Id Store::add_correction(const MapRow& map, const std::string& urdf) {
  const std::string corrected = corrected_map(blob(map.urdf).bytes);
  return add_map(map.name,
                 fmt::format("{}\n{}{} number {} -->\n", urdf, kCorrection,
                             corrected.empty() ? map.hash : corrected, maps().size()),
                 map.sidecar ? blob(*map.sidecar).bytes : std::string());
}

std::optional<MapRow> Store::map_at(const AsOf& as_of) const {
  std::vector<MapRow> all = maps();
  const std::optional<SceneRow> latest = all.size() < 2 ? std::nullopt : latest_scene(as_of);
  const auto perceived = latest ? std::ranges::find(all, latest->map, &MapRow::id) : all.end();
  if (perceived == all.end()) return all.empty() ? std::nullopt : std::optional(all.back());
  for (auto row = all.rbegin(); row != all.rend(); ++row)
    if (corrected_map(blob(row->urdf).bytes) == perceived->hash) return *row;
  return *perceived;
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
