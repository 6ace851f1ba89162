#include "memory/store/rows/table_rows.h"

#include <sqlite3.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/store/rows/derived_rows.h"
#include "memory/store/rows/digest.h"
#include "memory/store/rows/schema_check.h"

namespace loci::memory {
namespace {

TableColumn::Type type_of(const std::string& type) {
  return type == "INTEGER" ? TableColumn::Type::integer
         : type == "REAL"  ? TableColumn::Type::real
         : type == "BLOB"  ? TableColumn::Type::bytes
                           : TableColumn::Type::text;
}

TableLayout read_layout(SQLite::Database& database, const std::string& name, bool appended) {
  TableLayout table{.name = name, .appended = appended};
  std::map<int, size_t> key;
  SQLite::Statement columns(database, "SELECT name, type, \"notnull\", pk FROM pragma_table_info(?)");
  columns.bind(1, name);
  while (columns.executeStep()) {
    if (const int position = columns.getColumn(3).getInt(); position > 0)
      key[position] = table.columns.size();
    table.columns.push_back({columns.getColumn(0).getString(), type_of(columns.getColumn(1).getString()),
                             columns.getColumn(2).getInt() != 0});
  }
  for (const auto& [position, column] : key) {
    table.columns[column].required = true;
    table.key.push_back(column);
  }
  return table;
}

std::vector<TableLayout> read_layouts() {
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  database.exec(kMemoryFormat.schema);
  std::vector<TableLayout> tables;
  for (const std::string& name : digested_tables())
    tables.push_back(read_layout(database, name, name != RunRow::kTable));
  for (const char* name : {"forgotten", "forgotten_signature", "meta"})
    tables.push_back(read_layout(database, name, false));
  return tables;
}

/// "?, ?, ?"
std::string marks(size_t count) {
  return joined(std::vector<std::string>(count, "?"), ", ");
}

std::string_view bytes_of(const SQLite::Column& value) {
  return {static_cast<const char*>(value.getBlob()), static_cast<size_t>(value.getBytes())};
}

TableValue value_of(const SQLite::Column& value) {
  if (value.isNull()) return {};
  if (value.isInteger()) return int64_t{value.getInt64()};
  if (value.isFloat()) return value.getDouble();
  return bytes_of(value);
}

/// Runs `body` and names the file in errors of the database.
template <class Body>
auto guarded(const std::filesystem::path& memory, Body body) -> decltype(body()) {
  try {
    return body();
  } catch (const SQLite::Exception& error) {
    throw_database_error(error, memory);
  }
}

}  // namespace

std::string column_list(const TableLayout& table) {
  std::vector<std::string> names;
  for (const TableColumn& column : table.columns) names.push_back(sql_name(column.name));
  return joined(names, ", ");
}

std::string key_list(const TableLayout& table) {
  std::vector<std::string> names;
  for (const size_t column : table.key) names.push_back(sql_name(table.columns[column].name));
  return joined(names, ", ");
}

const std::vector<TableLayout>& table_layouts() {
  static const std::vector<TableLayout> tables = read_layouts();
  return tables;
}

TableKey key_of(const TableLayout& table, const TableRow& row) {
  TableKey key;
  for (const size_t column : table.key) {
    const TableValue& value = row.values[column];
    if (const auto* const number = std::get_if<int64_t>(&value))
      key.emplace_back(*number);
    else
      key.emplace_back(std::string(std::get<std::string_view>(value)));
  }
  return key;
}

struct TableReader::State {
  std::filesystem::path path;
  std::unique_ptr<SQLite::Database> database;
  std::map<std::string, uint64_t> digests;
};

TableReader::TableReader(std::filesystem::path memory) : state_(std::make_unique<State>()) {
  state_->path = std::move(memory);
  const Store store = Store::open_read(state_->path);
  if (1000 * store.major() + store.minor() != kMemoryFormat.version)
    throw store.error(fmt::format("has memory format {}.{}, not this program's {}.{}", store.major(),
                                  store.minor(), kMemoryFormat.major(), kMemoryFormat.minor()),
                      "an older one is migrated by any command that writes to it");
  guarded(state_->path, [&] {
    state_->database = open_database_to_read(state_->path);
    state_->database->exec("BEGIN");
    state_->digests = stored_digests(*state_->database);
  });
}

TableReader::~TableReader() = default;

std::string TableReader::created() const {
  return guarded(state_->path, [&] {
    SQLite::Statement row(*state_->database, "SELECT value FROM meta WHERE key = 'created'");
    return row.executeStep() ? row.getColumn(0).getString() : std::string();
  });
}

int64_t TableReader::count(const TableLayout& table) const {
  return guarded(state_->path, [&] {
    SQLite::Statement counted(*state_->database, "SELECT rows FROM row_count WHERE name = ?");
    counted.bind(1, table.name);
    return counted.executeStep()
               ? counted.getColumn(0).getInt64()
               : query_integer(*state_->database, "SELECT count(*) FROM " + sql_name(table.name));
  });
}

uint64_t TableReader::digest(const TableLayout& table) const {
  if (const auto found = state_->digests.find(table.name); found != state_->digests.end())
    return found->second;
  uint64_t sum = 0;
  read(table, {}, [&](const TableRow& row) {
    sum += row.digest;
    return true;
  });
  return sum;
}

void TableReader::read(const TableLayout& table, const std::optional<TableKey>& after,
                       const std::function<bool(const TableRow&)>& visitor) const {
  guarded(state_->path, [&] {
    const std::string key = key_list(table);
    const std::string condition =
        after ? fmt::format(" WHERE ({}) > ({})", key, marks(table.key.size())) : std::string();
    SQLite::Statement rows(*state_->database,
                           fmt::format("SELECT {} FROM {}{} ORDER BY {}", column_list(table),
                                       sql_name(table.name), condition, key));
    for (int i = 0; after && i < static_cast<int>(after->size()); ++i)
      std::visit([&](const auto& part) { rows.bind(i + 1, part); }, (*after)[static_cast<size_t>(i)]);
    TableRow row;
    row.values.resize(table.columns.size());
    while (rows.executeStep()) {
      for (size_t i = 0; i < row.values.size(); ++i)
        row.values[i] = value_of(rows.getColumn(static_cast<int>(i)));
      row.digest = row_digest(table.name, rows);
      if (!visitor(row)) return;
    }
  });
}

struct TableWriter::State {
  std::filesystem::path path;
  std::unique_ptr<SQLite::Database> database;
  std::unique_ptr<SQLite::Transaction> transaction;
  std::map<std::string, std::unique_ptr<SQLite::Statement>> inserts;
  std::map<std::string, uint64_t> digests;  ///< of the tables with the rows that were added
  std::map<std::string, int64_t> added;
  bool was_empty = true;
  bool conflict = false;  ///< a new row contradicts one that was there: that one has changed or gone
  // What tells which derived rows follow from the new ones.
  std::set<Id> observed, believed;
  Id last_observation = 0;  ///< before
  bool derive_all = false;

  /// Which derived rows follow from a new row.
  void note(const TableLayout& table, const TableRow& row);
  Id id(const TableLayout& table, const TableRow& row, const char* column) const;
};

Id TableWriter::State::id(const TableLayout& table, const TableRow& row, const char* column) const {
  const auto found = std::ranges::find(table.columns, column, &TableColumn::name);
  const auto* const number =
      std::get_if<int64_t>(&row.values[static_cast<size_t>(found - table.columns.begin())]);
  return number != nullptr ? *number : 0;
}

void TableWriter::State::note(const TableLayout& table, const TableRow& row) {
  if (table.name == AssociationRow::kTable || table.name == BeliefRow::kTable) {
    const Id object = id(table, row, "object");
    const bool belief = table.name == BeliefRow::kTable;
    if (object != 0 && belief) believed.insert(object);
    if (object != 0 && !belief && id(table, row, "chosen") == 1 && id(table, row, "observation") != 0)
      observed.insert(object);
    derive_all = derive_all || id(table, row, "supersedes") != 0;
  } else if (table.name == "annotation") {
    const Id observation = id(table, row, "observation");
    derive_all = derive_all || (observation != 0 && observation <= last_observation);
  }
}

TableWriter::TableWriter(std::filesystem::path memory) : state_(std::make_unique<State>()) {
  state_->path = std::move(memory);
  { const Store made = Store::open_write(state_->path); }
  guarded(state_->path, [&] {
    state_->database = open_database(state_->path.string(), SQLite::OPEN_READWRITE);
    SQLite::Database& database = *state_->database;
    trust_schema(database);
    database.exec("PRAGMA foreign_keys = OFF");  // rows may refer to those of tables that come later
    database.exec("PRAGMA secure_delete = ON");
    database.exec("PRAGMA synchronous = NORMAL");
    state_->transaction =
        std::make_unique<SQLite::Transaction>(database, SQLite::TransactionBehavior::IMMEDIATE);
    state_->digests = stored_digests(database);
    state_->last_observation = query_integer(database, "SELECT coalesce(max(id), 0) FROM observation");
    state_->was_empty = query_integer(database, "SELECT count(*) FROM (SELECT 1 FROM run LIMIT 1)") == 0;
  });
}

TableWriter::~TableWriter() = default;

std::optional<TableKey> TableWriter::last_key(const TableLayout& table) const {
  return guarded(state_->path, [&]() -> std::optional<TableKey> {
    std::string order;
    for (const size_t column : table.key)
      order += (order.empty() ? "" : ", ") + sql_name(table.columns[column].name) + " DESC";
    SQLite::Statement row(*state_->database, fmt::format("SELECT {} FROM {} ORDER BY {} LIMIT 1",
                                                         key_list(table), sql_name(table.name), order));
    if (!row.executeStep()) return {};
    TableKey key;
    for (int i = 0; i < row.getColumnCount(); ++i) key.emplace_back(int64_t{row.getColumn(i).getInt64()});
    return key;
  });
}

void TableWriter::clear(const TableLayout& table) {
  guarded(state_->path, [&] { state_->database->exec("DELETE FROM " + sql_name(table.name)); });
  state_->digests[table.name] = 0;
}

void TableWriter::add(const TableLayout& table, const TableRow& row) {
  guarded(state_->path, [&] {
    auto& insert = state_->inserts[table.name];
    if (!insert)
      insert = std::make_unique<SQLite::Statement>(
          *state_->database, fmt::format("INSERT INTO {} ({}) VALUES ({})", sql_name(table.name),
                                         column_list(table), marks(table.columns.size())));
    SqlColumns columns;
    SqlValues values;
    for (size_t i = 0; i < row.values.size(); ++i) {
      const bool bytes = table.columns[i].type == TableColumn::Type::bytes;
      struct ToSql {
        bool bytes;
        SqlValue operator()(std::monostate) const { return {}; }
        SqlValue operator()(int64_t number) const { return number; }
        SqlValue operator()(double number) const { return number; }
        SqlValue operator()(std::string_view text) const {
          return bytes ? SqlValue(BytesView{text}) : SqlValue(text);
        }
      };
      values.push_back(std::visit(ToSql{bytes}, row.values[i]));
      columns.emplace_back(table.columns[i].name.c_str(), values.back());
    }
    bind_values(*insert, values);
    try {
      insert->exec();
    } catch (const SQLite::Exception& error) {
      if ((error.getErrorCode() & 0xff) != SQLITE_CONSTRAINT) throw;
      state_->conflict = true;
    }
    insert->tryReset();
    state_->digests[table.name] += row_digest(table.name, columns, 0);
    ++state_->added[table.name];
    state_->note(table, row);
  });
}

bool TableWriter::commit() {
  return guarded(state_->path, [&] {
    if (state_->conflict) return false;
    SQLite::Database& database = *state_->database;
    std::map<std::string, uint64_t> expected = stored_digests(database);  // those of the other memory
    for (const std::string& table : digested_tables())
      if (state_->digests[table] != expected[table]) return false;
    if (state_->was_empty || state_->derive_all)
      derive_tables(database);
    else
      derive_tables_of(database, state_->observed, state_->believed, state_->added);
    state_->inserts.clear();
    state_->transaction->commit();
    database.exec("PRAGMA wal_checkpoint(PASSIVE)");
    return true;
  });
}

}  // namespace loci::memory
