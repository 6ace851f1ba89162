#include "memory/store/memory_file.h"

#include <SQLiteCpp/Backup.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <system_error>

#include "memory/store/database.h"
#include "memory/store/format.h"

namespace loci::memory {

namespace fs = std::filesystem;

namespace {

constexpr unsigned kPrivate = 0600;  ///< a home's private life

/// Verifies a memory under construction, which was made from `source`; it gets its name when there are no
/// problems.
BackupResult commit_verified(TemporaryMemory& made, const fs::path& source, Progress& progress) {
  BackupResult result;
  result.report = Store::open_read(made.path()).verify(progress);
  if (!result.report.problems.empty())
    throw Error(fmt::format("what was made from it has {} problems, the first: {}",
                            result.report.problems.size(), result.report.problems.front()),
                {source.string(), 0, {}}, "nothing was written; loci-memory verify lists them");
  result.bytes = static_cast<int64_t>(fs::file_size(made.path()));
  made.commit();
  return result;
}

/// Only a memory is replaced by one. Of a damaged one the beginning is left.
void require_memory(const fs::path& file) {
  std::error_code none;
  if (!fs::exists(file, none)) return;
  constexpr size_t kApplicationId = 68;  // in the header of SQLite, most significant byte first
  std::string head(kApplicationId + 4, '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  uint32_t id = 0;
  for (const char byte : head.substr(kApplicationId)) id = id << 8 | static_cast<unsigned char>(byte);
  if (!head.starts_with("SQLite format 3") || id != kMemoryApplicationId)
    throw Error("is no memory, it is not replaced", {file.string(), 0, {}},
                "move it away, or write to another path");
}

/// Keeps other programs out of a memory that is about to be replaced, and leaves it without a log.
std::unique_ptr<SQLite::Database> only_user_of(const fs::path& memory) {
  std::error_code none;
  if (!fs::exists(memory, none)) return nullptr;
  try {
    auto database = open_database(memory.string(), SQLite::OPEN_READWRITE);
    database->setBusyTimeout(0);
    // Only possible for the last user: it folds the log into the file.
    database->exec("PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = DELETE; BEGIN EXCLUSIVE");
    return database;
  } catch (const SQLite::Exception& error) {
    const int code = error.getErrorCode() & 0xff;
    if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) return nullptr;  // nobody can use it
    throw_database_error(error, memory);
  }
}

}  // namespace

TemporaryMemory::TemporaryMemory(const fs::path& memory, std::vector<fs::path> inputs, Replace replace)
    : memory_(fs::weakly_canonical(memory)),
      options_{.replace = replace, .inputs = std::move(inputs), .mode = kPrivate},
      file_(memory, options_) {
  refuse_foreign_side_files(memory_);
  // Private as they are, they must not lie about for ever.
  std::error_code ignored;
  for (const fs::path& abandoned : remove_abandoned(memory)) {
    remove_side_files(abandoned);
    fs::remove(abandoned.string() + ".lock", ignored);
  }
}

TemporaryMemory::~TemporaryMemory() {
  remove_side_files(path());
}

void TemporaryMemory::commit() {
  require_no_log(path());
  check_output(memory_, options_);  // before the log of one that appeared meanwhile would be removed
  remove_side_files(memory_);
  file_.commit();
}

PartialMemory::PartialMemory(const fs::path& memory)
    : path_(fs::weakly_canonical(memory).string() + ".partial") {
  remove();
}

void PartialMemory::remove() const {
  std::error_code ignored;
  for (const char* end : {"", ".lock"}) fs::remove(path_.string() + end, ignored);
  remove_side_files(path_);
}

std::vector<fs::path> kept_copies(const fs::path& memory) {
  const fs::path target = fs::weakly_canonical(memory);
  const std::string prefix = target.filename().string() + ".";
  static const std::regex kVersion("[0-9]+\\.[0-9]+(\\.[0-9]+)?");
  std::vector<fs::path> copies;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), none)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(prefix) && std::regex_match(name.substr(prefix.size()), kVersion))
      copies.push_back(entry.path());
  }
  std::ranges::sort(copies);
  return copies;
}

namespace {

constexpr const char* kSideFiles[] = {"-wal", "-shm", "-journal"};

/// Whether SQLite wrote a log, its index or a journal, by how they begin: at most bytes of 0 while empty.
bool is_side_file(const fs::path& file) {
  std::error_code none;
  if (!fs::is_regular_file(fs::symlink_status(file, none))) return false;
  std::string head(4, '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  for (const std::string_view log :
       {std::string_view("\x37\x7f\x06\x82"), std::string_view("\x37\x7f\x06\x83"),
        std::string_view("\xd9\xd5\x05\xf9"), std::string_view("\0\0\0\0", 4)})
    if (head == log) return true;
  constexpr uint32_t kIndexVersion = 3007000;  // in the byte order of the machine
  return head == std::string_view(reinterpret_cast<const char*>(&kIndexVersion), sizeof kIndexVersion);
}

}  // namespace

void refuse_foreign_side_files(const fs::path& memory) {
  std::error_code none;
  for (const char* end : kSideFiles)
    if (const fs::path file = memory.string() + end; fs::exists(file, none) && !is_side_file(file))
      throw Error("is in the way: a database keeps its log under this name", {file.string(), 0, {}},
                  "move it away, or write to another path");
}

void remove_side_files(const fs::path& memory) {
  std::error_code ignored;
  for (const char* end : kSideFiles)
    if (const fs::path file = memory.string() + end; is_side_file(file)) fs::remove(file, ignored);
}

void require_no_log(const fs::path& memory) {
  std::error_code none;
  for (const char* end : {"-wal", "-journal"})
    if (const auto bytes = fs::file_size(memory.string() + end, none); !none && bytes > 0)
      throw Error("cannot be written to its end: the disk is full or fails", {memory.string(), 0, {}},
                  kMakeRoom);
}

void copy_memory(const fs::path& from, const fs::path& to) {
  { const Store is_memory = Store::open_read(from); }
  copy_database(from, to);
}

void copy_database(const fs::path& from, const fs::path& to) {
  try {
    const auto source = open_database_to_read(from);
    const auto copy = open_database(to.string(), SQLite::OPEN_READWRITE);
    SQLite::Backup backup(*copy, *source);
    const int result = backup.executeStep(-1);
    if (result != SQLITE_DONE)
      throw Error("another program is using this memory", {from.string(), 0, {}},
                  "wait until it has finished");
  } catch (const SQLite::Exception& error) {
    throw_database_error(error, to);
  }
}

void create_atomically(const fs::path& memory, const std::vector<fs::path>& inputs,
                       const std::function<void(const fs::path&)>& fill) {
  TemporaryMemory made(memory, inputs);
  reported_of(memory, made.path(), [&] {
    fill(made.path());
    made.commit();
  });
}

void create_verified(const fs::path& memory, const std::vector<fs::path>& inputs, Progress& progress,
                     const std::function<void(const fs::path&)>& fill) {
  TemporaryMemory made(memory, inputs);
  reported_of(memory, made.path(), [&] {
    fill(made.path());
    commit_verified(made, inputs.front(), progress);
  });
}

BackupResult backup_memory(const fs::path& memory, const fs::path& backup, Progress& progress) {
  TemporaryMemory made(backup, {memory});
  return reported_of(backup, made.path(), [&] {
    copy_memory(memory, made.path());
    return commit_verified(made, memory, progress);
  });
}

BackupResult restore_memory(const fs::path& backup, const fs::path& memory, Replace replace,
                            Progress& progress) {
  if (replace != Replace::nothing) require_memory(memory);
  TemporaryMemory made(memory, {backup}, replace);
  const std::unique_ptr<SQLite::Database> replaced = only_user_of(memory);
  return reported_of(memory, made.path(), [&] {
    copy_memory(backup, made.path());
    return commit_verified(made, backup, progress);
  });
}

}  // namespace loci::memory
