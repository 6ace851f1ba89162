#pragma once

// The room's own header: the one place that sees SQLiteCpp's types.

#include <SQLiteCpp/SQLiteCpp.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <variant>

#include "memory/store/scene_transaction.h"
#include "memory/store/store.h"

namespace loci::memory {

/// Bytes, not text.
struct BytesView {
  std::string_view bytes;
};
using SqlValue = std::variant<std::monostate, int64_t, double, std::string_view, BytesView>;

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
template <StateEnum State>
SqlValue sql(State state) {
  return std::string_view(to_text(state));
}
SqlValue sql(std::string&& value) = delete;  // Only a view is kept: the text must outlive the columns.
template <class T>
SqlValue sql(const std::optional<T>& value) {
  return value ? sql(*value) : SqlValue();
}

/// Two parts, so that no text is made for each row.
struct SqlName {
  const char* prefix = "";
  const char* name = "";
  SqlName(const char* whole) : name(whole) {}
  SqlName(const char* first, const char* second) : prefix(first), name(second) {}
};
using SqlColumns = std::vector<std::pair<SqlName, SqlValue>>;

/// Adds `PREFIXx`, `PREFIXy`, `PREFIXz`; NULL when unset.
void add_vector(SqlColumns& columns, const char* prefix, const std::optional<Vector3d>& value);
/// Adds the seven columns of a pose.
void add_pose(SqlColumns& columns, const char* prefix, const std::optional<Isometry3d>& pose);
void add_color(SqlColumns& columns, const std::optional<HsvColor>& color);
void add_clock(SqlColumns& columns, const Bitemporal& clock);
void add_clock(SqlColumns& columns, Bitemporal&& clock) = delete;  // Its source is kept as a view.

/// The row that a query stands at, by column name.
class SqlRow {
 public:
  explicit SqlRow(SQLite::Statement& statement) : statement_(statement) {}

  bool is_null(std::string_view name) const { return column(name).isNull(); }
  int64_t integer(std::string_view name) const { return column(name).getInt64(); }
  double real(std::string_view name) const { return column(name).getDouble(); }
  std::string text(std::string_view name) const { return column(name).getString(); }
  template <StateEnum State>
  State state(std::string_view name) const {
    return parse_state<State>(text(name));
  }
  std::string bytes(std::string_view name) const;
  std::optional<int64_t> optional_integer(std::string_view name) const;
  std::optional<double> optional_real(std::string_view name) const;
  std::optional<std::string> optional_text(std::string_view name) const;
  std::optional<Vector3d> vector(std::string_view prefix) const;
  std::optional<Isometry3d> pose(std::string_view prefix) const;
  std::optional<HsvColor> color() const;
  Bitemporal clock() const;

 private:
  SQLite::Column column(std::string_view name) const;
  SQLite::Statement& statement_;
  mutable int next_ = 0;  ///< columns are mostly asked for in their order
};

/// A memory that is open: the database, its prepared statements, and the writer's lock.
struct Store::Implementation {
  ~Implementation();

  std::filesystem::path path;
  bool writable = false;
  int version = 0;
  WriteOptions options;
  int lock = -1;  ///< file descriptor of the lock file
  std::unique_ptr<SQLite::Database> database;
  std::unordered_map<std::string, std::unique_ptr<SQLite::Statement>> statements;
  std::unordered_map<std::string, Id> terms;  ///< some of the table of that name, by type and value
  /// How many there are, time and scene of the last, and where that was (unset = not known yet).
  struct Seen {
    int64_t count = 0;
    std::pair<TimeNs, Id> last = {};
    std::optional<Id> place = {};
  };
  /// What the transaction added: place and terms of each observation, and whether an object was seen as it.
  struct Fresh {
    Id place = 0;
    std::vector<Id> terms = {};
    bool associated = false;
  };
  std::unordered_map<Id, Fresh> just_seen;
  std::map<std::pair<Id, Id>, TimeNs> called;           ///< some of object_term: object and term, since when
  std::optional<Seen> scenes;                           ///< when known
  std::unordered_map<Id, Seen> sightings;               ///< of some of the objects
  std::unordered_map<std::string_view, int64_t> added;  ///< rows by table that row_count does not have yet
  bool in_scene = false;
  int moments = 0;  ///< that are being held

  /// A prepared statement, ready to be bound.
  SQLite::Statement& statement(const std::string& text);
  /// Runs a statement that gives no rows.
  void run(const char* text, const std::vector<SqlValue>& values);
  /// Adds a row. The same columns in the same order for each row of a table.
  Id insert(const char* table, const SqlColumns& columns);
  /// Runs a query and hands over its rows.
  template <class Visitor>
  void query(const std::string& text, const std::vector<SqlValue>& values, Visitor visitor);

  /// Runs `body` and turns the database's exceptions into Error with the file's name.
  template <class Body>
  auto guarded(Body body) -> decltype(body());
  /// guarded(), as one transaction.
  template <class Body>
  auto transaction(Body body) -> decltype(body());

  void need_writable() const;
  TimeNs known_time() const;

  Id add_blob(std::string_view bytes, const std::string& media);
  Id add_place(const PlaceRow& row, Id run, TimeNs known);
  Id add_fact(const FactRow& row, Id run, TimeNs known);
  Id add_term(const std::string& type, const std::string& value);
  /// Ends the object's last stay and begins the one that this belief tells of.
  void add_stay(Id belief, const BeliefRow& row, TimeNs from);
  /// The object was called so at that time.
  void add_object_term(Id object, Id term, TimeNs time);
  /// After a scene, or a sighting, was added.
  void mark_scene(Id scene, TimeNs time);
  void mark_sighting(Id object, Id observation, TimeNs time, Id scene);
  /// Before a commit: what was added goes into row_count.
  void keep_counts();
  /// What was read of the tables is to be read anew.
  void forget_cached();
};

/// `until` of a stay that goes on.
constexpr int64_t kOpenStay = 2147483647;

void bind_value(SQLite::Statement& statement, int index, const SqlValue& value);
void bind_values(SQLite::Statement& statement, const std::vector<SqlValue>& values);
[[noreturn]] void throw_database_error(const SQLite::Exception& error, const std::filesystem::path& path);

template <class Visitor>
void Store::Implementation::query(const std::string& text, const std::vector<SqlValue>& values,
                                  Visitor visitor) {
  SQLite::Statement& prepared = statement(text);
  bind_values(prepared, values);
  const SqlRow row(prepared);
  while (prepared.executeStep()) visitor(row);
  prepared.reset();
}

template <class Body>
auto Store::Implementation::guarded(Body body) -> decltype(body()) {
  try {
    return body();
  } catch (const SQLite::Exception& error) {
    throw_database_error(error, path);
  }
}

template <class Body>
auto Store::Implementation::transaction(Body body) -> decltype(body()) {
  need_writable();
  return guarded([&] {
    if (in_scene) return body();
    SQLite::Transaction all(*database, SQLite::TransactionBehavior::IMMEDIATE);
    added.clear();
    if constexpr (std::is_void_v<decltype(body())>) {
      body();
      keep_counts();
      all.commit();
    } else {
      auto result = body();
      keep_counts();
      all.commit();
      return result;
    }
  });
}

// zstd, with the database's encoding column.
struct Encoded {
  int encoding = 0;
  std::string bytes;
};
Encoded encode_bytes(std::string_view bytes);
std::string decode_bytes(std::string bytes, int64_t encoding, int64_t size,
                         const std::filesystem::path& path);

}  // namespace loci::memory
