#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <string>

namespace loci::memory {

/// Everything in a memory as text, except when it became known, by which run and how long it took: two
/// memories that were told the same have the same dump. How R*Tree and full text lie inside is left out.
inline std::string memory_dump(const std::filesystem::path& path) {
  const SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  std::string dump;
  SQLite::Statement tables(
      database,
      "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' AND "
      "name NOT IN ('run', 'meta') AND name NOT GLOB 'stay_*' AND name NOT GLOB 'term_text_*' ORDER BY name");
  while (tables.executeStep()) {
    const std::string table = tables.getColumn(0).getString();
    dump += "== " + table + "\n";
    SQLite::Statement rows(database, "SELECT * FROM " + table + " ORDER BY 1");
    while (rows.executeStep()) {
      for (int i = 0; i < rows.getColumnCount(); ++i) {
        const std::string column = rows.getColumnName(i);
        if (column == "known_from" || column == "known_to" || column == "run" || column == "milliseconds")
          continue;
        dump += rows.getColumn(i).isNull() ? std::string("NULL") : rows.getColumn(i).getString();
        dump += '|';
      }
      dump += '\n';
    }
  }
  return dump;
}

}  // namespace loci::memory
