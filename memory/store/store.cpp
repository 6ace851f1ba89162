#include "memory/store/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <cstring>

#include "mapping/base/hash.h"
#include "memory/store/database.h"
#include "memory/store/schema.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

FileLocation place_of(const fs::path& path) {
  return {path.string(), 0, {}};
}

fs::path lock_path(const fs::path& path) {
  return path.string() + ".lock";
}

/// One writer at a time. A lock beside the file, because closing another descriptor of the database file
/// itself would drop SQLite's own locks. It falls with its process.
int take_lock(const fs::path& path) {
  const fs::path name = lock_path(path);
  for (int attempt = 0; attempt < 10; ++attempt) {
    const int descriptor = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0)
      throw Error(std::string("cannot be written: ") + std::strerror(errno), place_of(path));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      ::close(descriptor);
      throw Error("another program is writing to this memory", place_of(path),
                  "wait until it has finished; reading is possible meanwhile");
    }
    // Between open and flock the last writer may have removed the name.
    struct stat mine {
    }, named{};
    if (::fstat(descriptor, &mine) == 0 && ::stat(name.c_str(), &named) == 0 && mine.st_ino == named.st_ino)
      return descriptor;
    ::close(descriptor);
  }
  throw Error("another program is writing to this memory", place_of(path), "try again");
}

int64_t pragma(SQLite::Database& database, const char* name) {
  return database.execAndGet(std::string("PRAGMA ") + name).getInt64();
}

bool is_blank(SQLite::Database& database) {
  return pragma(database, "application_id") == 0 &&
         database.execAndGet("SELECT count(*) FROM sqlite_master").getInt64() == 0;
}

/// Which program wrote the file, for the message about a version that is too new.
std::string written_by(SQLite::Database& database) {
  try {
    return database.execAndGet("SELECT value FROM meta WHERE key = 'written_by'").getString();
  } catch (const SQLite::Exception&) {
    return {};
  }
}

void check_version(SQLite::Database& database, const fs::path& path, int version) {
  if (pragma(database, "application_id") != kMemoryApplicationId)
    throw Error("is an SQLite database, but no memory of loci", place_of(path), "give a *.loci file");
  if (version / 1000 > kMemoryMajor) {
    const std::string writer = written_by(database);
    const std::string reader = writer.empty() ? fmt::format("loci {}.0 or later", version / 1000)
                                              : fmt::format("{} or later", writer);
    throw Error(fmt::format("has memory format {}.{}, this program reads up to {}.x", version / 1000,
                            version % 1000, kMemoryMajor),
                place_of(path), fmt::format("read it with {}", reader));
  }
  if (version < 1000) throw Error("has no memory format version", place_of(path), "the file is damaged");
}

/// One change of the schema: `sql` leads from the version before to `version`.
struct Migration {
  int version;
  const char* sql;
};
/// In order. The schema file is always that of the newest version.
const std::array<Migration, 5> kMigrations{{{1001, kMigrationTo1001},
                                            {1002, kMigrationTo1002},
                                            {1003, kMigrationTo1003},
                                            {1004, kMigrationTo1004},
                                            {1005, kMigrationTo1005}}};

void migrate(SQLite::Database& database, int version) {
  if (version >= kMemoryVersion) return;
  SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
  for (const Migration& migration : kMigrations)
    if (migration.version > version) database.exec(migration.sql);
  if (version < 1003) database.exec(kDerivation);
  database.exec(kCounting);
  database.exec(fmt::format("PRAGMA user_version = {}", kMemoryVersion));
  all.commit();
}

void create_schema(SQLite::Database& database, TimeNs known) {
  SQLite::Transaction all(database, SQLite::TransactionBehavior::IMMEDIATE);
  database.exec(kMemorySchema);
  database.exec(fmt::format("PRAGMA application_id = {}", kMemoryApplicationId));
  database.exec(fmt::format("PRAGMA user_version = {}", kMemoryVersion));
  SQLite::Statement meta(database, "INSERT INTO meta (key, value) VALUES (?, ?)");
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"format", "loci-memory"},
                                   {"created", format_time(known)},
                                   {"written_by", "loci " LOCI_VERSION}}) {
    meta.bind(1, key);
    meta.bind(2, value);
    meta.exec();
    meta.reset();
  }
  all.commit();
}

void configure(SQLite::Database& database) {
  database.setBusyTimeout(5000);
  database.exec("PRAGMA cache_size = -16000");  // 16 MB: what scenes change and questions ask again and again
  database.exec("PRAGMA foreign_keys = ON");
}

/// A memory without scenes, which is there as a whole or not at all, whenever the program is stopped.
void create_memory(const fs::path& path, TimeNs known) {
  const fs::path partial = path.string() + ".partial";
  std::error_code ignored;
  for (const char* end : {"", "-wal", "-shm", "-journal"}) fs::remove(partial.string() + end, ignored);
  {
    SQLite::Database database(partial.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    configure(database);
    create_schema(database, known);
    database.exec("PRAGMA journal_mode = WAL");
  }
  fs::rename(partial, path);
}

bool can_write(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return ::access(path.c_str(), W_OK) == 0 && ::access(folder.c_str(), W_OK) == 0;
}

/// A file that lies where nothing can be written beside it (a read-only medium) is read as it is.
std::unique_ptr<SQLite::Database> open_database_to_read(const fs::path& path) {
  // Opened so that the shared memory of the log can be set up and removed again; query_only keeps the rest.
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

Store::Implementation::~Implementation() {
  statements.clear();
  if (writable && database) {
    try {
      database->exec("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const SQLite::Exception&) {
      // The log stays beside the file and is taken over by whoever opens it next.
    }
  }
  database.reset();
  if (lock >= 0) {
    ::unlink(lock_path(path).c_str());
    ::close(lock);
  }
}

Store Store::open_read(const fs::path& path) {
  std::error_code code;
  if (!fs::exists(path, code)) throw Error("no such memory", place_of(path), "loci-perceive run makes one");
  if (fs::is_directory(path, code)) throw Error("is a folder, a memory file was expected", place_of(path));
  auto implementation = std::make_unique<Implementation>();
  implementation->path = path;
  implementation->guarded([&] {
    implementation->database = open_database_to_read(path);
    SQLite::Database& database = *implementation->database;
    configure(database);
    // Questions go to and fro in all of a long history.
    database.exec("PRAGMA cache_size = -64000");
    if (is_blank(database)) throw Error("is empty, no memory of loci", place_of(path), "give a *.loci file");
    implementation->version = static_cast<int>(pragma(database, "user_version"));
    check_version(database, path, implementation->version);
    if (implementation->version < 1001) database.exec(kViewsOf1000);
    if (implementation->version < 1003) database.exec(kViewsOf1002);
    if (implementation->version < 1005) database.exec(kViewsOf1004);
    if (can_write(path)) database.exec("PRAGMA query_only = ON");
  });
  return Store(std::move(implementation));
}

Store Store::open_write(const fs::path& path, const WriteOptions& options) {
  std::error_code code;
  if (fs::is_directory(path, code)) throw Error("is a folder, a memory file was expected", place_of(path));
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code)) throw Error("the folder does not exist", place_of(path));
  auto implementation = std::make_unique<Implementation>();
  implementation->path = path;
  implementation->options = options;
  implementation->lock = take_lock(path);
  const bool existed = fs::exists(path, code);
  try {
    implementation->guarded([&] {
      if (!existed) create_memory(path, implementation->known_time());
      implementation->database = std::make_unique<SQLite::Database>(path.string(), SQLite::OPEN_READWRITE);
      SQLite::Database& database = *implementation->database;
      configure(database);
      const bool blank = is_blank(database);
      if (!blank) {
        const auto version = static_cast<int>(pragma(database, "user_version"));
        check_version(database, path, version);
        if (version > kMemoryVersion)
          throw Error(
              fmt::format("has memory format {}.{}, newer than this program's {}.{}: it can only be read",
                          version / 1000, version % 1000, kMemoryMajor, kMemoryMinor),
              place_of(path), "write to it with a newer loci");
        migrate(database, version);
      }
      database.exec("PRAGMA journal_mode = WAL");
      database.exec("PRAGMA synchronous = NORMAL");
      // The same pages change with every scene: eight times the usual log carries each over less often.
      database.exec("PRAGMA wal_autocheckpoint = 8000");
      if (blank) create_schema(database, implementation->known_time());
      // Once: in a new memory, and where not all of these tables were counted yet.
      if (database.execAndGet("SELECT count(*) FROM row_count WHERE name = 'stay'").getInt64() == 0)
        database.exec(kCounting);
      database.exec("PRAGMA wal_checkpoint(TRUNCATE)");
      implementation->version = kMemoryVersion;
    });
  } catch (...) {
    if (!existed) {
      implementation->database.reset();
      for (const char* end : {"", ".partial"}) fs::remove(path.string() + end, code);
    }
    throw;
  }
  implementation->writable = true;
  return Store(std::move(implementation));
}

Store::Store(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

const fs::path& Store::path() const {
  return implementation_->path;
}
bool Store::writable() const {
  return implementation_->writable;
}
int Store::major() const {
  return implementation_->version / 1000;
}
int Store::minor() const {
  return implementation_->version % 1000;
}

Id Store::begin_run(const std::string& program, const std::string& configuration_json) {
  auto& s = *implementation_;
  return s.transaction([&] {
    return s.insert("run", {{"program", sql(program)},
                            {"version", std::string_view(LOCI_VERSION)},
                            {"configuration", sql(configuration_json)},
                            {"started", sql(s.known_time())}});
  });
}

void Store::finish_run(Id run) {
  auto& s = *implementation_;
  s.transaction([&] {
    SQLite::Statement& statement = s.statement("UPDATE run SET finished = ? WHERE id = ?");
    bind_values(statement, {sql(s.known_time()), sql(run)});
    statement.exec();
  });
}

Id Store::add_recording(const RecordingRow& row) {
  auto& s = *implementation_;
  if (const auto existing = recording(row.fingerprint)) return existing->id;
  return s.transaction([&] {
    return s.insert("recording", {{"fingerprint", sql(row.fingerprint)},
                                  {"name", sql(row.name)},
                                  {"kind", sql(row.kind)},
                                  {"time_assumed", sql(row.time_assumed)},
                                  {"frames", sql(row.frames)}});
  });
}

Id Store::add_map(const std::string& name, std::string_view urdf, std::string_view sidecar) {
  auto& s = *implementation_;
  const std::string hash = content_hash(content_hash(urdf) + content_hash(sidecar));
  return s.transaction([&] {
    std::optional<Id> known;
    s.query("SELECT id FROM map WHERE hash = ?", {sql(hash)},
            [&](const SqlRow& row) { known = row.integer("id"); });
    if (known) return *known;
    const Id urdf_blob = s.add_blob(urdf, "application/xml");
    std::optional<Id> sidecar_blob;
    if (!sidecar.empty()) sidecar_blob = s.add_blob(sidecar, "application/json");
    return s.insert(
        "map",
        {{"hash", sql(hash)}, {"name", sql(name)}, {"urdf", sql(urdf_blob)}, {"sidecar", sql(sidecar_blob)}});
  });
}

Id Store::add_place(const PlaceRow& row, Id run) {
  auto& s = *implementation_;
  return s.transaction([&] { return s.add_place(row, run, s.known_time()); });
}

Id Store::add_fact(const FactRow& row, Id run) {
  auto& s = *implementation_;
  return s.transaction([&] { return s.add_fact(row, run, s.known_time()); });
}

void Store::set_meta(const std::string& key, const std::string& value) {
  auto& s = *implementation_;
  s.transaction([&] {
    SQLite::Statement& statement = s.statement("INSERT OR REPLACE INTO meta (key, value) VALUES (?, ?)");
    bind_values(statement, {sql(key), sql(value)});
    statement.exec();
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
