#include "memory/fleet/fleet_database.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "mapping/base/load_symbol.h"
#include "mapping/base/text/percent.h"
#include "mapping/base/text/text.h"
#include "memory/store/format.h"
#include "memory/store/store.h"

namespace loci::memory {
namespace {

constexpr int kFleetVersion = 1;  ///< of fleet.sql
constexpr size_t kMaxNameBytes = 200;

/// Without the password in "//user:password@host".
std::string without_password(const std::string& url) {
  const size_t begin = url.find("//") + 2;
  const size_t end = std::min(url.find('/', begin), url.size());
  const size_t at = url.substr(0, end).rfind('@');
  const size_t colon = url.find(':', begin);
  if (at == std::string::npos || colon >= at) return url;
  return url.substr(0, colon) + url.substr(at);
}

/// CREATE TABLE of the tables of a memory, from memory/store/schema.sql.
std::string tables_sql() {
  std::string sql;
  for (const TableLayout& table : table_layouts()) {
    sql += fmt::format(
        "CREATE TABLE {} (\n  home text COLLATE \"C\" NOT NULL,\n  robot text COLLATE \"C\" NOT NULL,\n",
        table_name(table));
    for (const TableColumn& column : table.columns) {
      using enum TableColumn::Type;
      const char* type = column.type == integer ? "bigint"
                         : column.type == real  ? "double precision"
                         : column.type == text  ? "text COLLATE \"C\""
                                                : "bytea";
      sql += fmt::format("  {} {}{},\n", sql_name(column.name), type, column.required ? " NOT NULL" : "");
    }
    sql += fmt::format("  digest bigint NOT NULL,\n  PRIMARY KEY (home, robot, {})\n);\n", key_list(table));
    sql += fmt::format("SELECT loci.protect('{}');\n", table_name(table));
  }
  return sql;
}

std::string schema_sql() {
  std::string sql = kFleetSql;
  const std::string_view marker = "-- TABLES\n";
  sql.replace(sql.find(marker), marker.size(), tables_sql());
  return sql + fmt::format("INSERT INTO loci.version (fleet, memory_format) VALUES ({}, {});\n",
                           kFleetVersion, kMemoryFormat.version);
}

}  // namespace

std::unique_ptr<PostgresConnection> connect_to_postgres(const std::string& url, const std::string& shown) {
  using Connect = PostgresConnection* (*)(const std::string&, const std::string&);
  static const auto connect = reinterpret_cast<Connect>(
      load_symbol("loci_postgres.so", "loci_connect_to_postgres", "PostgreSQL cannot be used",
                  "install loci_postgres.so and libpq5"));
  return std::unique_ptr<PostgresConnection>(connect(url, shown));
}

bool is_fleet_url(std::string_view name) {
  return name.starts_with("postgresql://") || name.starts_with("postgres://");
}

FleetUrl parse_fleet_url(const std::string& url) {
  const size_t question = std::min(url.find('?'), url.size());
  FleetUrl parsed{.connection = url.substr(0, question)};
  parsed.shown = without_password(parsed.connection);
  const Error malformed("the query of the URL is malformed", {parsed.shown, 0, {}},
                        "write ?home=HOME&robot=ROBOT, with %XX for other characters");
  if (!is_fleet_url(url)) throw malformed;
  const size_t host = std::min(url.find("//") + 2, question), path = std::min(url.find('/', host), question);
  parsed.names_server =
      (path > host || url.find("host=", question) != std::string::npos) && path + 1 < question;
  char separator = '?';
  for (const std::string& part :
       split(std::string_view(url).substr(std::min(question + 1, url.size())), '&')) {
    if (part.empty()) continue;
    const size_t equals = std::min(part.find('='), part.size());
    const std::string name = part.substr(0, equals);
    if (name != "home" && name != "robot") {
      parsed.connection += separator + part;
      separator = '&';
      continue;
    }
    const auto value = percent_decoded(std::string_view(part).substr(std::min(equals + 1, part.size())));
    if (!value) throw malformed;
    (name == "home" ? parsed.home : parsed.robot) = *value;
  }
  return parsed;
}

void check_name(const RobotName& name) {
  for (const auto& [what, text] : {std::pair("home", &name.home), std::pair("robot", &name.robot)}) {
    if (text->empty()) throw Error(fmt::format("the name of the {} is empty", what));
    if (text->size() > kMaxNameBytes)
      throw Error(fmt::format("the name of the {} is longer than {} bytes", what, kMaxNameBytes));
    if (text->find('\0') != std::string::npos)
      throw Error(fmt::format("the name of the {} has a zero byte", what));
    require_utf8(*text);
  }
}

int64_t integer_of(const std::optional<std::string_view>& value) {
  uint64_t number = 0;
  for (const char c : value.value_or("")) number = number << 8 | static_cast<unsigned char>(c);
  if (value && value->size() == 4) return static_cast<int32_t>(static_cast<uint32_t>(number));
  return static_cast<int64_t>(number);
}

double real_of(const std::optional<std::string_view>& value) {
  return std::bit_cast<double>(integer_of(value));
}

std::string text_of(const std::optional<std::string_view>& value) {
  return std::string(value.value_or(""));
}

std::string table_name(const TableLayout& table) {
  return "loci." + sql_name(table.name);
}

std::string after_key(const TableLayout& table, const std::optional<TableKey>& key,
                      SqlParameters& parameters) {
  if (!key) return {};
  std::vector<std::string> marks;
  for (const auto& part : *key) {
    const bool number = std::holds_alternative<int64_t>(part);
    parameters.emplace_back(number ? std::to_string(std::get<int64_t>(part)) : std::get<std::string>(part));
    marks.push_back(fmt::format("${}::{}", parameters.size(), number ? "bigint" : "text"));
  }
  return fmt::format(" AND ({}) > ({})", key_list(table), joined(marks, ", "));
}

TableKey key_of(const TableLayout& table, ResultRow row) {
  TableKey key;
  for (size_t i = 0; i < table.key.size(); ++i) {
    if (table.columns[table.key[i]].type == TableColumn::Type::integer)
      key.emplace_back(integer_of(row[i]));
    else
      key.emplace_back(text_of(row[i]));
  }
  return key;
}

FleetDatabase::FleetDatabase(FleetUrl url)
    : url_(std::move(url)), connection_(connect_to_postgres(url_.connection, url_.shown)) {}

bool FleetDatabase::has_schema() {
  bool found = false;
  connection_->query("SELECT 1 FROM pg_catalog.pg_namespace WHERE nspname = 'loci'", {},
                     [&](ResultRow) { found = true; });
  return found;
}

void FleetDatabase::make_schema() {
  if (has_schema()) return;
  transaction([&] {
    connection_->run("SELECT pg_advisory_xact_lock(hashtext('loci schema'))");
    if (!has_schema()) connection_->run_script(schema_sql());
  });
}

std::string FleetDatabase::check_schema() {
  if (!has_schema())
    throw error("this database holds no memories", "loci-memory push, run by its owner, prepares it");
  std::string database;
  connection_->query("SELECT fleet, memory_format, database::text FROM loci.version", {}, [&](ResultRow row) {
    const int64_t fleet = integer_of(row[0]), format = integer_of(row[1]);
    if (fleet != kFleetVersion || format != kMemoryFormat.version)
      throw error(fmt::format("has version {} with memory format {}.{}, this program has {} with {}.{}",
                              fleet, format / 1000, format % 1000, kFleetVersion, kMemoryFormat.major(),
                              kMemoryFormat.minor()),
                  "use the loci that made the database, or push into a new one");
    database = text_of(row[2]);
  });
  if (database.empty()) throw error("has no version", "push into a new database");
  return database;
}

void FleetDatabase::roll_back() noexcept {
  try {
    connection_->run("ROLLBACK");
  } catch (const std::exception&) {
    // The connection is lost, and the transaction with it.
  }
}

}  // namespace loci::memory
