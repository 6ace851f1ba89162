#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace loci::memory {

/// Values of $1, $2, ... as text; unset = NULL. Values of users are never part of the text of a statement.
using SqlParameters = std::vector<std::optional<std::string>>;
/// A row in PostgreSQL's binary format: numbers begin with the highest byte. Unset = NULL.
using ResultRow = std::span<const std::optional<std::string_view>>;

/// A connection to PostgreSQL. Errors of the server are one-line Errors that name the database, without
/// password.
class PostgresConnection {
 public:
  virtual ~PostgresConnection() = default;

  /// Runs a statement; the rows that it changed.
  virtual int64_t run(const std::string& statement, const SqlParameters& parameters = {}) = 0;
  /// Runs several statements without parameters.
  virtual void run_script(const std::string& statements) = 0;
  /// Passes the rows of a query on as they come.
  virtual void query(const std::string& statement, const SqlParameters& parameters,
                     const std::function<void(ResultRow)>& visitor) = 0;
  /// Runs COPY ... FROM STDIN with the bytes that `fill` passes on, in parts of any size.
  virtual void copy_in(const std::string& statement,
                       const std::function<void(const std::function<void(std::string_view)>&)>& fill) = 0;
};

/// What loci_postgres.so offers. `url` is as libpq has it, `shown` names it in errors.
std::unique_ptr<PostgresConnection> connect_to_postgres(const std::string& url, const std::string& shown);

}  // namespace loci::memory
