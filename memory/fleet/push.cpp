#include "memory/fleet/push.h"

#include <fmt/format.h>

#include <bit>
#include <numeric>
#include <set>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"

namespace loci::memory {
namespace {

constexpr size_t kMaxBytes = size_t{16} << 20;  ///< of one transaction
constexpr size_t kSendBytes = size_t{1} << 16;

int64_t sum_of(const std::map<std::string, int64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), int64_t{0},
                         [](int64_t sum, const auto& count) { return sum + count.second; });
}

/// The rows of COPY in PostgreSQL's binary format.
class CopyRows {
 public:
  explicit CopyRows(const std::function<void(std::string_view)>& send) : send_(send) {
    buffer_.assign("PGCOPY\n\377\r\n\0\0\0\0\0\0\0\0\0", 19);
  }
  void begin_row(size_t values) { number(static_cast<int16_t>(values)); }
  void add(const TableValue& value, const TableColumn& column) {
    if (std::holds_alternative<std::monostate>(value)) return number(int32_t{-1});
    if (const auto* const text = std::get_if<std::string_view>(&value)) {
      number(static_cast<int32_t>(text->size()));
      buffer_ += *text;
      return;
    }
    const auto* const integer = std::get_if<int64_t>(&value);
    const double real = integer != nullptr ? static_cast<double>(*integer) : std::get<double>(value);
    add(column.type == TableColumn::Type::real || integer == nullptr ? std::bit_cast<int64_t>(real)
                                                                     : *integer);
  }
  void add(int64_t value) {
    number(int32_t{sizeof value});
    number(value);
  }
  void add(bool value) {
    number(int32_t{1});
    buffer_ += value ? '\1' : '\0';
  }
  void end_row() {
    if (buffer_.size() >= kSendBytes) flush();
    ++rows_;
  }
  void end() {
    number(int16_t{-1});
    flush();
  }
  int64_t rows() const { return rows_; }
  size_t bytes() const { return bytes_ + buffer_.size(); }

 private:
  template <class Integer>
  void number(Integer value) {
    for (int shift = 8 * (int{sizeof value} - 1); shift >= 0; shift -= 8)
      buffer_ += static_cast<char>(value >> shift & 0xff);
  }
  void flush() {
    send_(buffer_);
    bytes_ += buffer_.size();
    buffer_.clear();
  }

  const std::function<void(std::string_view)>& send_;
  std::string buffer_;
  int64_t rows_ = 0;
  size_t bytes_ = 0;
};

/// PostgreSQL's text has no zero byte and is UTF-8.
void check_texts(const TableLayout& table, const TableRow& row, const std::filesystem::path& memory) {
  for (size_t i = 0; i < row.values.size(); ++i) {
    const auto* const text = std::get_if<std::string_view>(&row.values[i]);
    if (text == nullptr || table.columns[i].type != TableColumn::Type::text) continue;
    if (text->find('\0') != std::string_view::npos)
      throw Error(fmt::format("{}.{} has a text with a zero byte", table.name, table.columns[i].name),
                  {memory.string(), 0, {}}, "PostgreSQL cannot hold it; correct or forget it");
  }
}

void add_row(CopyRows& copy, const TableLayout& table, const TableRow& row) {
  copy.begin_row(row.values.size() + 2);
  for (size_t i = 0; i < row.values.size(); ++i) copy.add(row.values[i], table.columns[i]);
  copy.add(static_cast<int64_t>(row.digest));
  copy.add(true);
  copy.end_row();
}

/// A row that is to go: nothing but its key.
void add_removal(CopyRows& copy, const TableLayout& table, const TableKey& key) {
  TableRow row;
  row.values.resize(table.columns.size());
  for (size_t i = 0; i < key.size(); ++i)
    std::visit([&](const auto& part) { row.values[table.key[i]] = TableValue(part); }, key[i]);
  copy.begin_row(row.values.size() + 2);
  for (size_t i = 0; i < row.values.size(); ++i) copy.add(row.values[i], table.columns[i]);
  copy.add(int64_t{0});
  copy.add(false);
  copy.end_row();
}

std::string bigint_array(const std::optional<TableKey>& key) {
  std::vector<std::string> parts;
  if (key)
    for (const auto& part : *key)
      if (const auto* const number = std::get_if<int64_t>(&part)) parts.push_back(std::to_string(*number));
  return "{" + joined(parts, ",") + "}";
}

}  // namespace

int64_t PushResult::added_rows() const {
  return sum_of(added);
}

int64_t PushResult::removed_rows() const {
  return sum_of(removed);
}

std::string PushResult::summary() const {
  if (transactions == 0) return "The database has all of it.";
  const auto rows = [](int64_t count) { return counted(static_cast<size_t>(count), "row"); };
  std::string text = rows(added_rows()) + " added";
  if (!removed.empty()) text += ", " + rows(removed_rows()) + " removed";
  return text + ".";
}

Json PushResult::report() const {
  return {{"added", added_rows()},
          {"removed", removed_rows()},
          {"added_by_table", added},
          {"removed_by_table", removed},
          {"transactions", transactions}};
}

/// Rows of the database by key, and whether there are more.
struct MemoryPush::Window {
  std::vector<std::pair<TableKey, uint64_t>> rows = {};
  bool last = false;
};

MemoryPush::MemoryPush(std::filesystem::path memory, FleetUrl url, PushOptions options)
    : memory_(std::move(memory)), options_(std::move(options)), database_([&] {
        check_name(options_.name);
        { const TableReader is_memory(memory_); }
        return FleetDatabase(std::move(url));
      }()) {
  database_.make_schema();
  database_.check_schema();
  // For the session: a killed push frees it when the server notices.
  database_.sql().run("SET lock_timeout = '10s'");
  database_.sql().query("SELECT pg_advisory_lock(hashtextextended($1 || E'\\x01' || $2, 1819239273))",
                        name_parameters(), [](ResultRow) {});
}

PushResult MemoryPush::run(Progress& progress) {
  const TableReader file(memory_);
  result_ = {};
  try {
    claim(file);
    read_cursors();
    total_rows_ = done_rows_ = 0;
    for (const TableLayout& table : table_layouts()) total_rows_ += file.count(table);
    for (const auto& [table, cursor] : cursors_) total_rows_ -= cursor.rows;
    for (const TableLayout& table : table_layouts())
      if (table.appended) append(file, table, progress);
    for (const TableLayout& table : table_layouts())
      if (cursors_[table.name].digest != file.digest(table)) reconcile(file, table, progress);
    if (in_transaction_ || result_.transactions > 0) commit(true);
  } catch (...) {
    database_.roll_back();
    in_transaction_ = false;
    throw;
  }
  return result_;
}

void MemoryPush::claim(const TableReader& file) {
  const std::string created = file.created();
  std::optional<std::string> there;
  bool complete = true;
  database_.sql().query("SELECT memory, complete FROM loci.robot WHERE home = $1 AND robot = $2",
                        name_parameters(), [&](ResultRow row) {
                          there = text_of(row[0]);
                          complete = integer_of(row[1]) != 0;
                        });
  if (there && *there != created && !options_.replace)
    throw database_.error(
        fmt::format("robot '{}' of home '{}' has another memory there, made {}; this one was made {}",
                    options_.name.robot, options_.name.home, *there, created),
        "name another robot, or replace its memory with --replace");
  const bool same = there && *there == created;
  if (same) require_tombstones(file);
  if (same && complete && !options_.replace) return;
  begin();
  SqlParameters parameters = name_parameters();
  parameters.emplace_back(created);
  parameters.emplace_back(options_.program + " " LOCI_VERSION);
  database_.sql().run(
      "INSERT INTO loci.robot (home, robot, memory, revision, complete, pushed, program) "
      "VALUES ($1, $2, $3, 0, false, now(), $4) "
      "ON CONFLICT (home, robot) DO UPDATE SET memory = excluded.memory",
      parameters);
  if (there && options_.replace) clear();
  options_.replace = false;  // once, not by each push that follows
}

void MemoryPush::require_tombstones(const TableReader& file) {
  const TableLayout& table =
      *std::ranges::find(table_layouts(), std::string("forgotten"), &TableLayout::name);
  std::set<TableKey> known;
  file.read(table, {}, [&](const TableRow& row) {
    known.insert(key_of(table, row));
    return true;
  });
  size_t missing = 0;
  database_.sql().query(
      fmt::format("SELECT {} FROM {} WHERE home = $1 AND robot = $2", key_list(table), table_name(table)),
      name_parameters(), [&](ResultRow row) { missing += known.contains(key_of(table, row)) ? 0 : 1; });
  if (missing > 0)
    throw Error(
        fmt::format("an older copy of the memory of robot '{}': the database lacks what was forgotten in "
                    "{}, which this file still has",
                    options_.name.robot, counted(missing, "request")),
        {memory_.string(), 0, {}},
        "push the file in which it was forgotten, or loci-memory merge both first");
}

void MemoryPush::clear() {
  for (const TableLayout& table : table_layouts())
    if (const int64_t removed = database_.sql().run(
            fmt::format("DELETE FROM {} WHERE home = $1 AND robot = $2", table_name(table)),
            name_parameters());
        removed > 0)
      result_.removed[table.name] += removed;
  database_.sql().run("DELETE FROM loci.cursor WHERE home = $1 AND robot = $2", name_parameters());
}

void MemoryPush::read_cursors() {
  cursors_.clear();
  database_.sql().query(
      "SELECT table_name, array_to_string(key, ','), rows, digest FROM loci.cursor WHERE home = $1 AND robot "
      "= $2",
      name_parameters(), [&](ResultRow row) {
        Cursor& cursor = cursors_[text_of(row[0])];
        cursor.rows = integer_of(row[2]);
        cursor.digest = static_cast<uint64_t>(integer_of(row[3]));
        if (const std::string key = text_of(row[1]); !key.empty()) {
          cursor.key.emplace();
          for (const std::string& part : split(key, ',')) cursor.key->emplace_back(int64_t{std::stoll(part)});
        }
      });
}

void MemoryPush::begin() {
  if (in_transaction_) return;
  database_.sql().run("BEGIN");
  in_transaction_ = true;
  open_rows_ = 0;
}

void MemoryPush::commit(bool complete) {
  begin();
  SqlParameters parameters = name_parameters();
  parameters.emplace_back(complete ? "true" : "false");
  parameters.emplace_back(options_.program + " " LOCI_VERSION);
  if (database_.sql().run("UPDATE loci.robot SET complete = $3::boolean, pushed = now(), program = $4, "
                          "revision = revision + $3::boolean::integer WHERE home = $1 AND robot = $2",
                          parameters) != 1)
    throw database_.error("the memory was removed meanwhile", "push it again");
  database_.sql().run("COMMIT");
  in_transaction_ = false;
  ++result_.transactions;
}

const std::string& MemoryPush::staging(const TableLayout& table) {
  std::string& name = staging_[table.name];
  if (name.empty()) {
    name = "pg_temp." + sql_name("staged_" + table.name);
    database_.sql().run(
        fmt::format("CREATE TEMPORARY TABLE IF NOT EXISTS {} ON COMMIT DELETE ROWS AS "
                    "SELECT {}, digest, true AS present FROM {} WITH NO DATA",
                    sql_name("staged_" + table.name), column_list(table), table_name(table)));
  }
  return name;
}

void MemoryPush::save_cursor(const TableLayout& table) {
  const Cursor& cursor = cursors_[table.name];
  SqlParameters parameters = name_parameters();
  parameters.emplace_back(table.name);
  parameters.emplace_back(bigint_array(cursor.key));
  parameters.emplace_back(std::to_string(cursor.rows));
  parameters.emplace_back(std::to_string(static_cast<int64_t>(cursor.digest)));
  database_.sql().run(
      "INSERT INTO loci.cursor VALUES ($1, $2, $3, $4::bigint[], $5::bigint, $6::bigint) ON CONFLICT (home, "
      "robot, "
      "table_name) DO UPDATE SET key = excluded.key, rows = excluded.rows, digest = excluded.digest",
      parameters);
}

void MemoryPush::append(const TableReader& file, const TableLayout& table, Progress& progress) {
  for (bool more = true; more;) {
    Cursor cursor = cursors_[table.name];
    int64_t rows = 0;
    more = false;
    const auto fill = [&](const std::function<void(std::string_view)>& send) {
      CopyRows copy(send);
      file.read(table, cursor.key, [&](const TableRow& row) {
        check_texts(table, row, memory_);
        add_row(copy, table, row);
        cursor.key = key_of(table, row);
        cursor.digest += row.digest;
        more = copy.rows() >= options_.max_rows || copy.bytes() >= kMaxBytes;
        return !more;
      });
      copy.end();
      rows = copy.rows();
    };
    bool any = false;  // most tables have nothing new when a push is repeated
    file.read(table, cursor.key, [&](const TableRow&) { return !(any = true); });
    if (!any) return;
    begin();
    const std::string& staged = staging(table);
    database_.sql().copy_in(fmt::format("COPY {} FROM STDIN (FORMAT binary)", staged), fill);
    const std::string columns = column_list(table);
    database_.sql().run(
        fmt::format("INSERT INTO {} (home, robot, {}, digest) SELECT $1, $2, {}, digest FROM {}",
                    table_name(table), columns, columns, staged),
        name_parameters());
    cursor.rows += rows;
    cursors_[table.name] = cursor;
    result_.added[table.name] += rows;
    save_cursor(table);
    done_rows_ += rows;
    progress.check(double(done_rows_) / double(std::max(total_rows_, done_rows_ + 1)),
                   "pushing " + table.name);
    open_rows_ += rows;
    if (more || open_rows_ >= options_.max_rows) commit(false);
  }
}

MemoryPush::Window MemoryPush::read_window(const TableLayout& table, const std::optional<TableKey>& after) {
  Window window;
  SqlParameters parameters = name_parameters();
  const std::string condition = after_key(table, after, parameters);
  database_.sql().query(
      fmt::format("SELECT {0}, digest FROM {1} WHERE home = $1 AND robot = $2{2} ORDER BY {0} LIMIT {3}",
                  key_list(table), table_name(table), condition, options_.max_rows),
      parameters, [&](ResultRow row) {
        window.rows.emplace_back(key_of(table, row),
                                 static_cast<uint64_t>(integer_of(row[table.key.size()])));
      });
  window.last = static_cast<int64_t>(window.rows.size()) < options_.max_rows;
  return window;
}

void MemoryPush::apply_staged(const TableLayout& table) {
  const std::string& staged = staging(table);
  std::vector<std::string> same_key;
  for (const size_t column : table.key)
    same_key.push_back(fmt::format("old.{0} = staged.{0}", sql_name(table.columns[column].name)));
  database_.sql().run(
      fmt::format("DELETE FROM {} old USING {} staged WHERE old.home = $1 AND old.robot = $2 AND {}",
                  table_name(table), staged, joined(same_key, " AND ")),
      name_parameters());
  const std::string columns = column_list(table);
  database_.sql().run(
      fmt::format("INSERT INTO {} (home, robot, {}, digest) SELECT $1, $2, {}, digest FROM {} WHERE present",
                  table_name(table), columns, columns, staged),
      name_parameters());
}

void MemoryPush::reconcile(const TableReader& file, const TableLayout& table, Progress& progress) {
  begin();
  const std::string& staged = staging(table);
  Cursor cursor;
  for (bool last = false; !last;) {
    const Window window = read_window(table, cursor.key);
    last = window.last;
    int64_t added = 0, removed = 0;
    database_.sql().run("TRUNCATE " + staged);
    database_.sql().copy_in(
        fmt::format("COPY {} FROM STDIN (FORMAT binary)", staged),
        [&](const std::function<void(std::string_view)>& send) {
          CopyRows copy(send);
          size_t next = 0;
          const auto remove_before = [&](const TableKey* key) {
            for (; next < window.rows.size() && (key == nullptr || window.rows[next].first < *key); ++next) {
              add_removal(copy, table, window.rows[next].first);
              ++removed;
            }
          };
          file.read(table, cursor.key, [&](const TableRow& row) {
            const TableKey key = key_of(table, row);
            if (!last && key > window.rows.back().first) return false;
            remove_before(&key);
            cursor.digest += row.digest;
            ++cursor.rows;
            if (last) cursor.key = key;
            const bool there = next < window.rows.size() && window.rows[next].first == key;
            const bool same = there && window.rows[next].second == row.digest;
            next += there ? 1 : 0;
            if (same) return true;
            check_texts(table, row, memory_);
            add_row(copy, table, row);
            ++added;
            removed += there ? 1 : 0;
            return true;
          });
          remove_before(nullptr);
          copy.end();
        });
    if (!last) cursor.key = window.rows.back().first;
    if (added + removed == 0) continue;
    apply_staged(table);
    if (added > 0) result_.added[table.name] += added;
    if (removed > 0) result_.removed[table.name] += removed;
    progress.check(0.99, "correcting " + table.name);
  }
  database_.sql().run("TRUNCATE " + staged);
  if (!table.appended) cursor.key.reset();
  cursors_[table.name] = cursor;
  save_cursor(table);
}

}  // namespace loci::memory
