#pragma once

#include "mapping/base/error.h"
#include "memory/fleet/postgres_connection.h"
#include "memory/store/rows/table_rows.h"

namespace loci::memory {

/// The name of a memory in a database: postgresql://user@host:port/database?home=H&robot=R, else as libpq has
/// it. In home and robot, %20 stands for a blank and so on.
struct FleetUrl {
  std::string connection = {};  ///< for libpq, without home and robot
  std::string shown = {};       ///< without password
  std::optional<std::string> home = {}, robot = {};
  bool names_server = false;  ///< server and database are in it, not left to libpq's environment
};
/// Whether a name of a memory means one in a database.
bool is_fleet_url(std::string_view name);
/// Error when it is malformed.
FleetUrl parse_fleet_url(const std::string& url);

/// Whose memory.
struct RobotName {
  std::string home = {}, robot = {};
  auto operator<=>(const RobotName&) const = default;
};
/// Error unless both are UTF-8, not empty, and up to 200 bytes long.
void check_name(const RobotName& name);

/// Numbers of a ResultRow.
int64_t integer_of(const std::optional<std::string_view>& value);
double real_of(const std::optional<std::string_view>& value);
std::string text_of(const std::optional<std::string_view>& value);

/// The table in the database, quoted.
std::string table_name(const TableLayout& table);
/// " AND (key) > ($n::bigint, ...)", the parameters added; empty for an unset key.
std::string after_key(const TableLayout& table, const std::optional<TableKey>& key,
                      SqlParameters& parameters);
/// The key in the columns of a result.
TableKey key_of(const TableLayout& table, ResultRow row);

/// A database that holds the memories of robots (memory/fleet/fleet.sql).
class FleetDatabase {
 public:
  /// Connects. Error when the server cannot be reached.
  explicit FleetDatabase(FleetUrl url);

  const FleetUrl& url() const { return url_; }
  PostgresConnection& sql() { return *connection_; }
  Error error(const std::string& what, const std::string& hint = {}) const {
    return Error(what, {url_.shown, 0, {}}, hint);
  }

  /// Makes the schema when there is none; several programs may try at once.
  void make_schema();
  /// Error when there is no schema, or one of another version. The id of the database.
  std::string check_schema();
  /// Runs `body` as one transaction.
  template <class Body>
  void transaction(Body body, const char* begin = "BEGIN") {
    connection_->run(begin);
    try {
      body();
      connection_->run("COMMIT");
    } catch (...) {
      roll_back();
      throw;
    }
  }
  /// Does nothing without a transaction, or on a lost connection.
  void roll_back() noexcept;

 private:
  bool has_schema();

  FleetUrl url_;
  std::unique_ptr<PostgresConnection> connection_;
};

extern const char* const kFleetSql;  ///< memory/fleet/fleet.sql

}  // namespace loci::memory
