#pragma once

// Private to this module: the database through SQLiteCpp, whose types no other module sees.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <variant>

#include "memory/store/format.h"
#include "memory/store/scene_transaction.h"
#include "memory/store/store.h"

namespace loci::memory {

/// Bytes, not text.
struct BytesView {
  std::string_view bytes;
};
/// A value to be bound. Text and bytes are views and must outlive the execution.
using SqlValue = std::variant<std::monostate, int64_t, double, std::string_view, BytesView>;
using SqlValues = std::vector<SqlValue>;

inline SqlValue sql(int64_t value) {
  return value;
}
inline SqlValue sql(int value) {
  return int64_t{value};
}
inline SqlValue sql(bool value) {
  return int64_t{value ? 1 : 0};
}
inline SqlValue sql(double value) {
  return value;
}
inline SqlValue sql(const std::string& value) {
  return std::string_view(value);
}
SqlValue sql(std::string&& value) = delete;
template <StateEnum State>
SqlValue sql(State state) {
  return std::string_view(to_text(state));
}
template <class T>
SqlValue sql(const std::optional<T>& value) {
  return value ? sql(*value) : SqlValue();
}

/// A column's name in two parts, so that no text is built for each row.
struct SqlName {
  const char* prefix = "";
  const char* name = "";
  SqlName(const char* whole) : name(whole) {}
  SqlName(const char* first, const char* second) : prefix(first), name(second) {}
};
using SqlColumns = std::vector<std::pair<SqlName, SqlValue>>;

/// The row at which a query stands, by column name.
class SqlRow {
 public:
  explicit SqlRow(SQLite::Statement& statement) : statement_(statement) {}

  /// An integer, bool, double, string, state, or an optional of these (unset = NULL).
  template <class T>
  T get(std::string_view name) const {
    return convert<T>(column(name));
  }
  template <class T>
  T first() const {
    return convert<T>(statement_.getColumn(0));
  }
  bool is_null(std::string_view name) const { return column(name).isNull(); }
  std::string bytes(std::string_view name) const;

 private:
  /// Every value of a row passes here: numbers that do not fit their type are refused.
  template <class T>
  static T convert(const SQLite::Column& value);
  [[noreturn]] static void refuse_value(const SQLite::Column& value);
  SQLite::Column column(std::string_view name) const;

  SQLite::Statement& statement_;
  mutable std::vector<std::string_view>
      names_;                ///< of the columns, once one was read: SQLite is slow to name them
  mutable size_t next_ = 0;  ///< columns are mostly read in their order
};

template <class T>
T SqlRow::convert(const SQLite::Column& value) {
  if constexpr (requires { typename T::value_type; } && !std::is_same_v<T, std::string>)
    return value.isNull() ? T() : T(convert<typename T::value_type>(value));
  else if constexpr (StateEnum<T>)
    return parse_state<T>(value.getText());
  else if constexpr (std::is_same_v<T, bool>)
    return value.getInt64() != 0;
  else if constexpr (std::is_integral_v<T>) {
    if (!std::in_range<T>(value.getInt64())) refuse_value(value);
    return static_cast<T>(value.getInt64());
  } else if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(value.getDouble())) refuse_value(value);
    return value.getDouble();
  } else
    return value.getString();
}

/// The condition of a query with its values, which are bound by number.
class Where {
 public:
  explicit Where(std::string text = "1", SqlValues values = {})
      : text_(std::move(text)), values_(std::move(values)) {}

  /// Known at `known_at`; unset = not superseded.
  Where& known(const AsOf& as_of);
  /// Valid from `at` or before.
  Where& begun(const AsOf& as_of);
  /// Valid at `at`; unset = not ended.
  Where& holds(const AsOf& as_of);
  /// `column` up to `at`, and added by `known_at`: of rows that are never superseded.
  Where& added(const char* column, const AsOf& as_of);
  /// Corrections add rows of visibility: the newest of an object in a scene holds.
  Where& newest_visibility(const AsOf& as_of);
  /// The condition that annotation `n` is not a label, or the one that holds of its observation.
  std::string label_holds(const AsOf& as_of);
  Where& between(const char* column, std::optional<TimeNs> from, std::optional<TimeNs> to);
  Where& and_also(const std::string& condition);
  /// A value for use in conditions: "?3".
  std::string bind(SqlValue value);

  const std::string& text() const { return text_; }
  const SqlValues& values() const { return values_; }

 private:
  std::string text_;
  SqlValues values_;
};

/// Compressed by zstd where that helps, as the columns `encoding` and `content` have it.
struct Encoded {
  int encoding = 0;
  std::string bytes;
};
Encoded encode_bytes(std::string_view bytes);
std::string decode_bytes(std::string bytes, int64_t encoding, int64_t size,
                         const std::filesystem::path& path);

/// Query for the id of the next new object. Ids of forgotten objects are not given again.
inline constexpr const char* kNextObject =
    "SELECT max((SELECT coalesce(max(id), 0) + 1 FROM main.object), coalesce((SELECT CAST(value AS INTEGER) "
    "FROM "
    "main.meta WHERE key = 'next_object'), 1))";

/// An open memory: the database, its prepared statements, and the writer's lock.
struct Store::Connection {
  ~Connection();

  std::filesystem::path path;
  std::filesystem::path lock_name;  ///< of the lock file
  bool writable = false;
  int version = 0;
  std::optional<TimeNs> now;  ///< as in WriteOptions
  TimeNs last_known = 0;      ///< see known_time
  int lock = -1;              ///< file descriptor of the lock file
  MemoryFormat format{};
  std::filesystem::path kept_before_migration;
  std::unique_ptr<SQLite::Database> database;
  std::unordered_map<std::string, std::unique_ptr<SQLite::Statement>> statements;
  bool in_scene = false;
  std::string replica_of = {};          ///< URL of the memory whose copy the file is; empty = of none
  int open_transactions = 0;            ///< for writing, each inside of the one before
  int read_transactions = 0;            ///< that are open
  std::optional<bool> superseded = {};  ///< whether an association is; while read transactions are open

  // ---- Caches of the writer.
  /// How many there are, time and scene of the last, and where that was (unset = not read yet).
  struct Sequence {
    int64_t count = 0;
    std::pair<TimeNs, Id> last = {};
    std::optional<Id> place = {};
  };
  /// An observation that the open transaction added.
  struct NewObservation {
    Id place = 0;
    std::vector<Id> terms = {};
    bool associated = false;
  };
  std::unordered_map<Id, NewObservation> new_observations;
  std::unordered_map<std::string, Id> terms;            ///< some of table term, by type and value
  std::map<std::pair<Id, Id>, TimeNs> object_terms;     ///< some of table object_term
  std::optional<Sequence> scenes;                       ///< of all scenes
  std::unordered_map<Id, Sequence> observations;        ///< of some objects
  std::unordered_map<std::string_view, int64_t> added;  ///< rows by table that row_count does not have yet
  std::map<std::string_view, uint64_t> digests;         ///< of these rows, and of changes

  /// A prepared statement, ready to be bound.
  SQLite::Statement& statement(const std::string& text);
  /// Runs a statement that returns no rows.
  void run(const std::string& text, const SqlValues& values);
  /// Adds a row. A table must always be given the same columns in the same order.
  Id insert(const char* table, const SqlColumns& columns);
  template <class Visitor>
  void query(const std::string& text, const SqlValues& values, Visitor visitor);
  /// The first column of all rows, or of the last one (unset = no row).
  template <class T>
  std::vector<T> values(const std::string& text, const SqlValues& values = {});
  template <class T>
  std::optional<T> value(const std::string& text, const SqlValues& values = {});

  /// Runs `body` and turns the exceptions of the database, and errors about values of rows, into Error with
  /// the name of the file.
  template <class Body>
  auto guarded(Body body) -> decltype(body());
  /// A transaction for writing; inside of another one it is a savepoint of that.
  void begin();
  void commit();
  void roll_back() noexcept;
  /// guarded() as one transaction; inside a scene it is part of the scene's.
  template <class Body>
  auto transaction(Body body) -> decltype(body());

  /// Whether observations must be read through association_known: some may not be known any more, or not yet.
  bool needs_known(const AsOf& as_of);
  void require_writable() const;
  /// For messages.
  std::string name() const { return replica_of.empty() ? path.string() : replica_of; }
  /// Transaction time. Never before that of a row there is: a clock that jumped back must not make what is
  /// new known before what it replaces.
  TimeNs known_time() {
    if (now) return *now;
    return last_known = std::max(last_known, loci::now());
  }
  Error error(const std::string& what, const std::string& hint = {}) const {
    return Error(what, {name(), 0, {}}, hint);
  }

  /// Of the next new object: higher than that of any object ever, forgotten ones included.
  Id next_object_id();
  Id add_blob(std::string_view bytes, const std::string& media);
  Id add_place(const PlaceRow& row, Id run, TimeNs known);
  Id add_fact(const FactRow& row, Id run, TimeNs known);
  Id add_term(const std::string& type, const std::string& value);

  // ---- Derived rows (derived_rows.cpp).
  /// Ends the last stay of the object and begins that of this belief.
  void add_stay(Id belief, const BeliefRow& row, TimeNs from);
  /// Annotations called the object so at that time.
  void add_object_term(Id object, Id term, TimeNs time);
  /// After a scene, or an observation of an object, was added.
  void rank_scene(Id scene, TimeNs time);
  void rank_observation(Id object, Id observation, TimeNs time, Id scene);
  /// Before a commit: adds `added` to row_count.
  void save_counts();
  /// Derives all of them from the other tables.
  void derive_all();
  void clear_caches();
};

/// Removes blobs that no column refers to.
void drop_unused_blobs(SQLite::Database& database);
/// Overwrites what was deleted, in the file and in its log.
void overwrite_deleted(SQLite::Database& database);
/// Opens a database file. What a file brings along cannot do harm: functions with side effects are not called
/// from its schema, its shadow tables are not written directly, and damaged pages are recognised.
std::unique_ptr<SQLite::Database> open_database(const std::string& name, int flags);
/// For a writer whose file has passed check_schema(): its triggers keep the full-text index, which SQLite
/// only allows to a schema that is trusted.
void trust_schema(SQLite::Database& database);
/// Opens a memory for reading. A file in a folder where nothing can be written (a read-only medium) is opened
/// as immutable.
std::unique_ptr<SQLite::Database> open_database_to_read(const std::filesystem::path& path);
bool can_write(const std::filesystem::path& path);
[[noreturn]] void throw_database_error(const SQLite::Exception& error, const std::filesystem::path& path);
void bind_values(SQLite::Statement& statement, const SqlValues& values);
/// Runs several statements; each is bound to as many of the values as it has parameters. Returns the rows
/// changed.
int64_t run_statements(SQLite::Database& database, const std::string& text, const SqlValues& values = {});
int64_t query_integer(SQLite::Database& database, const std::string& text);

template <class Visitor>
void Store::Connection::query(const std::string& text, const SqlValues& values, Visitor visitor) {
  SQLite::Statement& prepared = statement(text);
  bind_values(prepared, values);
  const SqlRow row(prepared);
  while (prepared.executeStep()) visitor(row);
  prepared.reset();
}

template <class T>
std::vector<T> Store::Connection::values(const std::string& text, const SqlValues& values) {
  return guarded([&] {
    std::vector<T> result;
    query(text, values, [&](const SqlRow& row) { result.push_back(row.first<T>()); });
    return result;
  });
}

template <class T>
std::optional<T> Store::Connection::value(const std::string& text, const SqlValues& values) {
  return guarded([&] {
    std::optional<T> result;
    query(text, values, [&](const SqlRow& row) { result = row.first<T>(); });
    return result;
  });
}

template <class Body>
auto Store::Connection::guarded(Body body) -> decltype(body()) {
  try {
    return body();
  } catch (const SQLite::Exception& error) {
    throw_database_error(error, name());
  } catch (const Error& error) {
    if (!error.location().file.empty()) throw;
    throw Error(error.message(), {name(), 0, error.location().key}, error.hint());
  }
}

template <class Body>
auto Store::Connection::transaction(Body body) -> decltype(body()) {
  require_writable();
  return guarded([&] {
    if (in_scene) return body();
    begin();
    try {
      if constexpr (std::is_void_v<decltype(body())>) {
        body();
        commit();
      } else {
        auto result = body();
        commit();
        return result;
      }
    } catch (...) {
      roll_back();
      throw;
    }
  });
}

}  // namespace loci::memory
