#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "memory/store/rows/rows.h"

namespace loci::memory {

// The rows of a memory as they are, for copies of it in another database. Derived tables and checkpoints,
// from which no answer follows, are left out.

/// An identifier in SQL text: "name", quotes in it doubled.
std::string sql_name(std::string_view identifier);

struct TableColumn {
  enum class Type { integer, real, text, bytes };
  std::string name = {};
  Type type = Type::integer;
  bool required = false;  ///< never NULL
};

struct TableLayout {
  std::string name = {};
  std::vector<TableColumn> columns = {};
  std::vector<size_t> key = {};  ///< columns of the primary key, in order
  /// New rows come after all others in the order of the key, which is of integers. Of other tables, which are
  /// small, any row may change. (Forgetting and retention change and remove rows everywhere.)
  bool appended = true;
};

/// The names of the columns of a table, or of its key, as SQL has them: "a", "b".
std::string column_list(const TableLayout& table);
std::string key_list(const TableLayout& table);

/// The tables of this program's schema.
const std::vector<TableLayout>& table_layouts();

/// NULL, a number, or a view of text or bytes.
using TableValue = std::variant<std::monostate, int64_t, double, std::string_view>;
using TableKey = std::vector<std::variant<int64_t, std::string>>;

struct TableRow {
  std::vector<TableValue> values = {};  ///< in the order of the columns; views last until the next row
  uint64_t digest = 0;                  ///< of all values; of a blob by its hash
};
TableKey key_of(const TableLayout& table, const TableRow& row);

/// Reads a memory in one state, that of the first access, whatever a writer adds meanwhile.
class TableReader {
 public:
  /// Error when the file is not a memory, or one of another version than this program writes.
  explicit TableReader(std::filesystem::path memory);
  ~TableReader();
  TableReader(const TableReader&) = delete;
  TableReader& operator=(const TableReader&) = delete;

  /// When the memory was made, as its meta has it: what tells memories apart.
  std::string created() const;
  int64_t count(const TableLayout& table) const;
  /// The sum of the digests of all rows.
  uint64_t digest(const TableLayout& table) const;
  /// Rows after a key (unset = all) in the order of the key, until `visitor` returns false.
  void read(const TableLayout& table, const std::optional<TableKey>& after,
            const std::function<bool(const TableRow&)>& visitor) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Fills a memory with the rows of another one, in one transaction.
class TableWriter {
 public:
  /// Makes the memory when it is not there.
  explicit TableWriter(std::filesystem::path memory);
  ~TableWriter();  ///< without commit(), nothing has changed
  TableWriter(const TableWriter&) = delete;
  TableWriter& operator=(const TableWriter&) = delete;

  /// The largest key; unset = no row.
  std::optional<TableKey> last_key(const TableLayout& table) const;
  /// Before the rows of a table are added that is not appended to.
  void clear(const TableLayout& table);
  /// The digest of the row is computed.
  void add(const TableLayout& table, const TableRow& row);
  /// Derives what follows from the new rows, and keeps all. False, and nothing is kept, when the tables are
  /// not those of the other memory by its digests: rows that were there before have changed or gone.
  bool commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace loci::memory
