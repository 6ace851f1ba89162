#include <algorithm>
#include <map>

#include "mapping/base/json.h"
#include "memory/store/reading.h"

namespace loci::memory {
namespace {

/// The table that an index or a table of R*Tree or full text belongs to.
std::map<std::string, std::string> owners(Store::Implementation& store) {
  std::map<std::string, std::string> result;
  store.query("SELECT name, tbl_name FROM sqlite_master WHERE type IN ('table', 'index')", {},
              [&](const SqlRow& row) { result[row.text("name")] = row.text("tbl_name"); });
  for (auto& [name, table] : result)
    for (const char* parent : {"stay", "term_text"})
      if (table.starts_with(std::string(parent) + "_")) table = parent;
  return result;
}

}  // namespace

std::vector<Store::TableSize> Store::statistics(bool with_bytes) const {
  auto& s = *implementation_;
  return s.guarded([&] {
    const std::map<std::string, std::string> owner = owners(s);
    std::map<std::string, TableSize> sizes;
    for (const auto& [name, table] : owner) sizes[table].table = table;
    std::map<std::string, int64_t> counted;
    s.query("SELECT name, rows FROM row_count", {},
            [&](const SqlRow& row) { counted[row.text("name")] = row.integer("rows"); });
    for (auto& [table, size] : sizes) {
      const auto known = counted.find(table);
      size.rows = known != counted.end()
                      ? known->second
                      : s.database->execAndGet(fmt::format("SELECT count(*) FROM {}", table)).getInt64();
    }
    if (with_bytes) {
      s.query("SELECT name, pgsize FROM dbstat WHERE aggregate = 1", {}, [&](const SqlRow& row) {
        const auto found = owner.find(row.text("name"));
        sizes[found == owner.end() ? "sqlite_schema" : found->second].bytes += row.integer("pgsize");
      });
      sizes["sqlite_schema"].table = "sqlite_schema";
    }
    std::vector<TableSize> result;
    for (auto& [table, size] : sizes) result.push_back(std::move(size));
    std::ranges::stable_sort(result,
                             [](const TableSize& a, const TableSize& b) { return a.bytes > b.bytes; });
    return result;
  });
}

void Store::read_view(const std::string& view, const std::function<void(const Json&)>& visitor) const {
  auto& s = *implementation_;
  s.guarded([&] {
    SQLite::Statement known(*s.database, "SELECT 1 FROM sqlite_master WHERE type = 'view' AND name = ?");
    known.bind(1, view);
    if (!known.executeStep()) throw Error("there is no view " + view, {path().string(), 0, {}});
    SQLite::Statement rows(*s.database, "SELECT * FROM " + view);
    while (rows.executeStep()) {
      Json row = Json::object();
      for (int i = 0; i < rows.getColumnCount(); ++i) {
        const SQLite::Column value = rows.getColumn(i);
        Json& cell = row[rows.getColumnName(i)];
        if (value.isInteger())
          cell = value.getInt64();
        else if (value.isFloat())
          cell = value.getDouble();
        else if (value.isText())
          cell = value.getString();
      }
      visitor(row);
    }
  });
}

}  // namespace loci::memory
