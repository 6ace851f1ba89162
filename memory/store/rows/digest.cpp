#include "memory/store/rows/digest.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <sstream>

namespace loci::memory {
namespace {

constexpr const char* kKey = "digests";

/// Tables whose rows follow from no others. (Checkpoints are replaced with every scene, and no answer depends
/// on them.)
struct DigestedTable {
  std::string_view name;
  bool has_id = true;
};
constexpr std::array<DigestedTable, 20> kTables = {{{"run"},
                                                    {"blob"},
                                                    {"map"},
                                                    {"place"},
                                                    {"recording"},
                                                    {"scene"},
                                                    {"scene_log", false},
                                                    {"observation"},
                                                    {"term"},
                                                    {"annotation"},
                                                    {"type_system"},
                                                    {"feature_structure"},
                                                    {"feature_structure_blob", false},
                                                    {"object"},
                                                    {"association"},
                                                    {"event"},
                                                    {"belief"},
                                                    {"visibility"},
                                                    {"fact"},
                                                    {"reasoning", false}}};

using Digests = std::map<std::string, uint64_t>;

/// The finalizer of SplitMix64.
uint64_t mixed(uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}

uint64_t digest_of(std::string_view bytes, uint64_t kind) {
  uint64_t digest = mixed(bytes.size() ^ kind << 60);
  for (size_t i = 0; i < bytes.size(); i += sizeof(uint64_t)) {
    uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min(sizeof word, bytes.size() - i));
    digest = mixed(digest ^ word);
  }
  return digest;
}

uint64_t digest_of(int64_t number) {
  return mixed(static_cast<uint64_t>(number));
}

/// A whole number has one digest, whether a column stores it as an integer or as a real.
uint64_t digest_of(double number) {
  constexpr double kWhole = 9007199254740992;  // 2^53
  if (std::abs(number) <= kWhole && number == std::floor(number))
    return digest_of(static_cast<int64_t>(number));
  return digest_of({reinterpret_cast<const char*>(&number), sizeof number}, 1);
}

/// Columns count by name, so that their order does not matter; NULL counts as nothing.
uint64_t column_digest(std::string_view prefix, std::string_view name, uint64_t value) {
  return mixed(value + digest_of(std::string(prefix).append(name), 2));
}

/// The bytes of a blob have a hash of their own.
bool counts(std::string_view table, std::string_view column) {
  return table != "blob" || column != "content";
}

const DigestedTable* find_table(std::string_view name) {
  const auto* const found = std::ranges::find(kTables, name, &DigestedTable::name);
  return found == kTables.end() ? nullptr : found;
}

Digests computed(SQLite::Database& database) {
  Digests digests;
  for (const DigestedTable& table : kTables) {
    uint64_t& sum = digests[std::string(table.name)];
    SQLite::Statement rows(database, fmt::format("SELECT * FROM {}", table.name));
    while (rows.executeStep()) sum += row_digest(table.name, rows);
  }
  return digests;
}

std::string text_of(const Digests& digests) {
  std::string text;
  for (const auto& [table, digest] : digests) text += fmt::format("{} {:016x}\n", table, digest);
  return text;
}

Digests digests_from(const std::string& text) {
  Digests digests;
  std::istringstream lines(text);
  for (std::string table, digest; lines >> table >> digest;)
    std::from_chars(digest.data(), digest.data() + digest.size(), digests[table], 16);
  return digests;
}

}  // namespace

uint64_t row_digest(std::string_view table, const SqlColumns& columns, Id id) {
  struct Digest {
    uint64_t operator()(std::monostate) const { return 0; }
    uint64_t operator()(int64_t number) const { return digest_of(number); }
    uint64_t operator()(double number) const { return digest_of(number); }
    uint64_t operator()(std::string_view text) const { return digest_of(text, 3); }
    uint64_t operator()(BytesView view) const { return digest_of(view.bytes, 4); }
  };
  const DigestedTable* const known = find_table(table);
  if (known == nullptr) return 0;
  const bool chosen_id = std::ranges::any_of(
      columns, [](const auto& column) { return std::string_view(column.first.name) == "id"; });
  uint64_t sum = known->has_id && !chosen_id ? column_digest("", "id", digest_of(id)) : 0;
  for (const auto& [name, value] : columns) {
    const double* const number = std::get_if<double>(&value);
    const bool is_null =
        std::holds_alternative<std::monostate>(value) || (number != nullptr && std::isnan(*number));
    if (!is_null && counts(table, name.name))
      sum += column_digest(name.prefix, name.name, std::visit(Digest(), value));
  }
  return mixed(sum);
}

uint64_t row_digest(std::string_view table, SQLite::Statement& row) {
  uint64_t sum = 0;
  for (int i = 0; i < row.getColumnCount(); ++i) {
    const SQLite::Column value = row.getColumn(i);
    if (value.isNull() || !counts(table, value.getName())) continue;
    const std::string_view bytes = value.isInteger() || value.isFloat()
                                       ? std::string_view()
                                       : std::string_view(static_cast<const char*>(value.getBlob()),
                                                          static_cast<size_t>(value.getBytes()));
    const uint64_t digest = value.isInteger() ? digest_of(value.getInt64())
                            : value.isFloat() ? digest_of(value.getDouble())
                                              : digest_of(bytes, value.isText() ? 3 : 4);
    sum += column_digest("", value.getName(), digest);
  }
  return mixed(sum);
}

std::map<std::string, uint64_t> stored_digests(SQLite::Database& database) {
  SQLite::Statement stored(database, "SELECT value FROM meta WHERE key = ?");
  stored.bind(1, kKey);
  return stored.executeStep() ? digests_from(stored.getColumn(0).getString()) : Digests();
}

std::vector<std::string> digested_tables() {
  std::vector<std::string> names;
  for (const DigestedTable& table : kTables) names.emplace_back(table.name);
  return names;
}

void derive_digests(SQLite::Database& database) {
  const std::string text = text_of(computed(database));
  SQLite::Statement store(database, "INSERT OR REPLACE INTO meta (key, value) VALUES (?, ?)");
  store.bind(1, kKey);
  store.bind(2, text);
  store.exec();
}

void add_to_digests(Store::Connection& db, const std::map<std::string_view, uint64_t>& added) {
  const auto stored = db.value<std::string>("SELECT value FROM meta WHERE key = ?", {std::string_view(kKey)});
  if (!stored || added.empty()) return;
  Digests digests = digests_from(*stored);
  for (const auto& [table, digest] : added)
    if (find_table(table) != nullptr) digests[std::string(table)] += digest;
  const std::string text = text_of(digests);
  db.run("UPDATE meta SET value = ? WHERE key = ?", {sql(text), std::string_view(kKey)});
}

std::vector<std::string> digest_problems(Store::Connection& db) {
  std::vector<std::string> problems;
  const auto stored = db.value<std::string>("SELECT value FROM meta WHERE key = ?", {std::string_view(kKey)});
  if (!stored) return problems;  // of a program that did not keep them yet
  Digests expected = digests_from(*stored);
  for (const auto& [table, digest] : computed(*db.database))
    if (expected[table] != digest)
      problems.push_back(
          fmt::format("table {} is not as it was written: rows were changed, added or removed", table));
  return problems;
}

}  // namespace loci::memory
