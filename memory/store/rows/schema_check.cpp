#include "memory/store/rows/schema_check.h"

#include <algorithm>
#include <cctype>
#include <mutex>

#include "mapping/base/text/hash.h"

namespace loci::memory {
namespace {

/// A row of sqlite_schema.
struct SchemaObject {
  std::string type, table, sql;  ///< sql without comments and needless blanks
  std::vector<std::string> columns = {};

  bool operator==(const SchemaObject& other) const {
    return type == other.type && table == other.table && sql == other.sql;
  }
  bool is_virtual() const { return sql.starts_with("CREATE VIRTUAL TABLE"); }
};
using Schema = std::map<std::string, SchemaObject>;

/// What follows a comment or a quoted text that begins at `begin`; `begin` where there is none.
size_t end_of_comment(std::string_view sql, size_t begin) {
  const bool line = sql.substr(begin, 2) == "--", block = sql.substr(begin, 2) == "/*";
  if (!line && !block) return begin;
  const size_t end = line ? sql.find('\n', begin) : sql.find("*/", begin + 2);
  return end == std::string_view::npos ? sql.size() : end + (line ? 1 : 2);
}

size_t end_of_quoted(std::string_view sql, size_t begin) {
  const char open = sql[begin];
  if (open != '\'' && open != '"' && open != '`' && open != '[') return begin;
  const size_t end = sql.find(open == '[' ? ']' : open, begin + 1);
  return end == std::string_view::npos ? sql.size() : end + 1;
}

/// Without comments, blanks as single spaces, and none beside brackets and commas. ALTER TABLE leaves other
/// blanks than the schema has.
std::string normalised(std::string_view sql) {
  std::string result;
  bool blank = false;
  for (size_t i = 0; i < sql.size();) {
    if (const size_t end = end_of_comment(sql, i); end > i) {
      blank = true;
      i = end;
      continue;
    }
    if (std::isspace(static_cast<unsigned char>(sql[i])) != 0) {
      blank = true;
      ++i;
      continue;
    }
    constexpr std::string_view kTight = "(),";
    const bool tight = kTight.find(sql[i]) != std::string_view::npos ||
                       (!result.empty() && kTight.find(result.back()) != std::string_view::npos);
    if (blank && !tight && !result.empty()) result += ' ';
    blank = false;
    const size_t end = std::max(end_of_quoted(sql, i), i + 1);
    result += sql.substr(i, end - i);
    i = end;
  }
  return result;
}

std::vector<std::string> columns_of(SQLite::Database& database, const std::string& table) {
  std::vector<std::string> columns;
  // Hidden ones are generated, or those of a virtual table.
  SQLite::Statement info(database, fmt::format("PRAGMA main.table_xinfo({})", sql_name(table)));
  while (info.executeStep())
    if (info.getColumn("hidden").getInt() == 0) columns.push_back(info.getColumn("name").getString());
  return columns;
}

Schema read_schema(SQLite::Database& database) {
  Schema schema;
  // Statistics that ANALYZE collected are no part of it; names that begin so are reserved.
  SQLite::Statement rows(database,
                         "SELECT type, name, tbl_name, coalesce(sql, '') FROM main.sqlite_schema WHERE name "
                         "NOT LIKE 'sqlite\\_stat%' ESCAPE '\\'");
  while (rows.executeStep())
    schema[rows.getColumn(1).getString()] = {rows.getColumn(0).getString(), rows.getColumn(2).getString(),
                                             normalised(rows.getColumn(3).getString())};
  return schema;
}

std::string digest_of(const Schema& schema) {
  std::string text;
  for (const auto& [name, object] : schema)
    for (const std::string& part : {object.type, name, object.table, object.sql}) text += part + '\0';
  return content_hash(text);
}

/// The schema of a version of the format, this one or an older one.
const Schema& schema_of(int version, const MemoryFormat& format) {
  static std::mutex mutex;
  static std::map<std::pair<const char*, int>, Schema> known;
  const std::scoped_lock lock(mutex);
  const auto [entry, is_new] = known.try_emplace({format.schema, version});
  if (is_new) {
    SQLite::Database database(":memory:", SQLite::OPEN_READWRITE);
    database.exec(format.schema);
    for (size_t i = format.migrations.size(); i-- > 0 && format.migrations[i].version > version;)
      database.exec(format.migrations[i].revert);
    entry->second = read_schema(database);
    for (auto& [name, object] : entry->second)
      if (object.type == "table" && !object.is_virtual()) object.columns = columns_of(database, name);
  }
  return entry->second;
}

/// A name of the file for people: on one line, and not endless.
std::string shown(std::string name) {
  constexpr size_t kMaxLength = 60;
  if (name.size() > kMaxLength) name = name.substr(0, kMaxLength) + "...";
  for (char& c : name)
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = '?';
  return name;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(what, {path.string(), 0, {}}, "nothing of the file was run; restore it from a backup");
}

void check_equal(const Schema& found, const Schema& expected, const std::filesystem::path& path) {
  for (const auto& [name, object] : found) {
    const auto known = expected.find(name);
    if (known == expected.end())
      refuse(path, fmt::format("has a {} '{}', which no memory of its version has", shown(object.type),
                               shown(name)));
    if (object != known->second)
      refuse(path,
             fmt::format("its {} '{}' is not that of a memory of its version", shown(object.type), name));
  }
  for (const auto& [name, object] : expected)
    if (!found.contains(name)) refuse(path, fmt::format("lacks the {} '{}'", object.type, name));
}

/// That the tables of a newer minor version can be read as this program knows them.
void check_known_tables(SQLite::Database& database, const Schema& found, const Schema& expected,
                        const std::filesystem::path& path) {
  for (const auto& [name, object] : expected) {
    if (object.type != "table") continue;
    const auto there = found.find(name);
    if (there == found.end()) refuse(path, fmt::format("lacks the table '{}'", name));
    const SchemaObject& table = there->second;
    bool as_known = object.is_virtual() ? table == object : table.type == "table" && !table.is_virtual();
    if (as_known && !object.is_virtual()) {
      const std::vector<std::string> columns = columns_of(database, name);
      as_known = std::ranges::all_of(object.columns, [&](const std::string& column) {
        return std::ranges::find(columns, column) != columns.end();
      });
    }
    if (!as_known) refuse(path, fmt::format("its table '{}' is not that of a memory", name));
  }
}

}  // namespace

std::string schema_digest(SQLite::Database& database) {
  return digest_of(read_schema(database));
}

std::string sql_name(std::string_view identifier) {
  std::string result = "\"";
  for (const char c : identifier) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + '"';
}

void check_schema(SQLite::Database& database, const std::filesystem::path& path, int version,
                  const MemoryFormat& format) {
  const Schema found = read_schema(database);
  // Making the schema to compare with takes longer than most questions.
  if (version == format.version && digest_of(found) == format.schema_digest) return;
  if (version > format.version)
    check_known_tables(database, found, schema_of(format.version, format), path);
  else
    check_equal(found, schema_of(version, format), path);
}

void shadow_views(SQLite::Database& database, const MemoryFormat& format) {
  constexpr std::string_view kCreate = "CREATE VIEW ";
  for (const auto& [name, object] : schema_of(format.version, format))
    if (object.type == "view") database.exec("CREATE TEMP VIEW " + object.sql.substr(kCreate.size()));
}

bool has_object(const MemoryFormat& format, const std::string& type, const std::string& name) {
  const Schema& schema = schema_of(format.version, format);
  const auto found = schema.find(name);
  return found != schema.end() && found->second.type == type;
}

}  // namespace loci::memory
