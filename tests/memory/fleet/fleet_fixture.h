#pragma once

#include <gmock/gmock.h>

#include <map>

#include "mapping/base/text/json.h"
#include "memory/fleet/fleet_replica.h"
#include "memory/fleet/push.h"
#include "tests/memory/store/temporary_folder.h"
#include "tests/support/postgres_server.h"
#include "tests/support/random_memory.h"

namespace loci::memory::testing_support {

using loci::testing_support::PostgresServer;
using loci::testing_support::RandomMemory;

/// A server with an empty database, and a memory.
class FleetTest : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    std::string why_not;
    server_ = PostgresServer::start(why_not);
    if (!server_) GTEST_SKIP() << why_not;
    server_->create_database("loci");
    random_ = std::make_unique<RandomMemory>(file_, 1);
  }

  std::string url(const std::string& query = "", const std::string& role = "postgres") const {
    return server_->url("loci", role, query);
  }
  std::unique_ptr<PostgresConnection> connection(const std::string& role = "postgres") const {
    return connect_to_postgres(url("", role), "test");
  }
  void sql(const std::string& database, const std::string& statements) const {
    connect_to_postgres(server_->url(database), "test")->run_script(statements);
  }
  void sql(const std::string& statements) const { sql("loci", statements); }
  int64_t number(const std::string& query) const {
    int64_t number = -1;
    connection()->query("SELECT (" + query + ")::bigint", {},
                        [&](ResultRow row) { number = integer_of(row[0]); });
    return number;
  }

  PushResult push(const std::filesystem::path& file, const RobotName& name = {"home", "robot"},
                  const std::string& role = "postgres", int64_t max_rows = 20000) const {
    NoProgress silent;
    return MemoryPush(file, parse_fleet_url(url("", role)), {.name = name, .max_rows = max_rows}).run(silent);
  }
  PushResult push() const { return push(file_); }
  std::filesystem::path pull(const std::string& query = "", const std::string& role = "postgres") const {
    NoProgress silent;
    return FleetReplica(url(query, role), folder_ / "cache").update(silent);
  }

  /// Rows of the file and of the database that differ, of all tables, and wrong sums of digests.
  std::vector<std::string> differences(const std::filesystem::path& file,
                                       const RobotName& name = {"home", "robot"}) const {
    std::vector<std::string> found;
    const TableReader reader(file);
    const auto database = connection();
    for (const TableLayout& table : table_layouts()) {
      std::map<TableKey, std::string> rows;
      reader.read(table, {}, [&](const TableRow& row) {
        rows[loci::memory::key_of(table, row)] = text(table, row) + std::to_string(int64_t(row.digest));
        return true;
      });
      size_t count = 0;
      database->query("SELECT " + column_list(table) + ", digest FROM " + table_name(table) +
                          " WHERE home = $1 AND robot = $2",
                      {name.home, name.robot}, [&](ResultRow result) {
                        TableRow row;
                        for (size_t i = 0; i < table.columns.size(); ++i)
                          row.values.push_back(value(table, i, result));
                        const auto same = rows.find(loci::memory::key_of(table, row));
                        const std::string shown =
                            text(table, row) + std::to_string(integer_of(result[table.columns.size()]));
                        if (same == rows.end() || same->second != shown)
                          found.push_back(table.name + ": " + shown);
                        ++count;
                      });
      if (count != rows.size())
        found.push_back(table.name + ": " + std::to_string(rows.size()) + " rows, not " +
                        std::to_string(count));
    }
    return found;
  }

  static TableValue value(const TableLayout& table, size_t i, ResultRow row) {
    if (!row[i]) return {};
    if (table.columns[i].type == TableColumn::Type::integer) return integer_of(row[i]);
    if (table.columns[i].type == TableColumn::Type::real) return real_of(row[i]);
    return *row[i];
  }
  static std::string text(const TableLayout& table, const TableRow& row) {
    std::string text;
    for (size_t i = 0; i < row.values.size(); ++i) {
      text += table.columns[i].name + "=";
      if (const auto* const number = std::get_if<int64_t>(&row.values[i])) text += std::to_string(*number);
      if (const auto* const real = std::get_if<double>(&row.values[i])) text += fmt::format("{}", *real);
      if (const auto* const bytes = std::get_if<std::string_view>(&row.values[i])) text += *bytes;
      text += std::holds_alternative<std::monostate>(row.values[i]) ? "NULL|" : "|";
    }
    return text;
  }

  std::unique_ptr<PostgresServer> server_;
  std::unique_ptr<RandomMemory> random_;
};

}  // namespace loci::memory::testing_support
