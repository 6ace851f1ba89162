#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "mapping/base/output_file.h"
#include "memory/store/store.h"

namespace loci::memory {

/// The hint of errors that a full disk, a quota or a broken disk causes.
inline constexpr const char* kMakeRoom = "committed scenes are kept; make room and resume";

/// A memory under construction beside `memory`, private to its user. Removed with its log and lock when it
/// goes out of scope, unless it was committed.
class TemporaryMemory {
 public:
  /// Error when `memory` exists, unless `replace` allows it, or is one of `inputs`.
  explicit TemporaryMemory(const std::filesystem::path& memory,
                           std::vector<std::filesystem::path> inputs = {},
                           Replace replace = Replace::nothing);
  ~TemporaryMemory();
  TemporaryMemory(const TemporaryMemory&) = delete;
  TemporaryMemory& operator=(const TemporaryMemory&) = delete;

  const std::filesystem::path& path() const { return file_.temporary(); }
  /// Takes its name. A log that lies at that name, of a memory that is gone, is never replayed into it.
  void commit();

 private:
  std::filesystem::path memory_;
  OutputOptions options_;
  OutputFile file_;
};

/// The name under which a memory is rewritten in place, so that the next writer finds what a killed one left.
/// What lies there is removed when it is made, and when it goes out of scope.
class PartialMemory {
 public:
  explicit PartialMemory(const std::filesystem::path& memory);
  ~PartialMemory() { remove(); }
  PartialMemory(const PartialMemory&) = delete;
  PartialMemory& operator=(const PartialMemory&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void remove() const;

  std::filesystem::path path_;
};

/// The copies beside a memory that migrations kept: FILE.1.0, FILE.1.0.2.
std::vector<std::filesystem::path> kept_copies(const std::filesystem::path& memory);

/// Error when a file beside `memory` has the name of its log or journal and is none of SQLite's: SQLite would
/// overwrite it.
void refuse_foreign_side_files(const std::filesystem::path& memory);

/// Removes the log, its index and the journal of a memory that is not there; a file of somebody else that is
/// called so stays.
void remove_side_files(const std::filesystem::path& memory);

/// Error while some of what was written to a closed memory is only in its log: SQLite leaves it there when
/// the disk fails at the end, and a file that is renamed alone would lose it.
void require_no_log(const std::filesystem::path& memory);

/// Copies a memory as it is at this moment into a file that is empty, also while a program writes to it. All
/// of the copy is in the one file.
void copy_memory(const std::filesystem::path& from, const std::filesystem::path& to);

/// The same of a file that is known to be a memory.
void copy_database(const std::filesystem::path& from, const std::filesystem::path& to);

/// Runs `body`, which writes a temporary file for a memory; an Error about that file is reported of the
/// memory.
template <class Body>
auto reported_of(const std::filesystem::path& memory, const std::filesystem::path& temporary, Body body)
    -> decltype(body()) {
  try {
    return body();
  } catch (const Error& error) {
    if (error.location().file != temporary.string()) throw;
    const bool is_full = error.hint() == kMakeRoom;
    throw Error(error.message(), {memory.string(), 0, {}},
                is_full                ? "nothing was changed; make room, or write it elsewhere"
                : error.hint().empty() ? "nothing was changed"
                                       : "nothing was changed; " + error.hint());
  }
}

/// Creates a memory completely or not at all: `fill` writes it under a temporary name, which then becomes
/// `memory`. Error when `memory` exists.
void create_atomically(const std::filesystem::path& memory, const std::vector<std::filesystem::path>& inputs,
                       const std::function<void(const std::filesystem::path&)>& fill);

/// The same of a memory that is verified before it gets its name: Error, and no memory, when `fill` made one
/// that is not sound.
void create_verified(const std::filesystem::path& memory, const std::vector<std::filesystem::path>& inputs,
                     Progress& progress, const std::function<void(const std::filesystem::path&)>& fill);

/// What a backup holds, or the memory that was restored from it.
struct BackupResult {
  int64_t bytes = 0;    ///< of the file
  VerifyReport report;  ///< of what was written: without problems
};

/// Copies a memory as it is at this moment, also while a program writes to it, and verifies the copy. Error,
/// and no copy, when that finds problems, or when `backup` exists.
BackupResult backup_memory(const std::filesystem::path& memory, const std::filesystem::path& backup,
                           Progress& progress);

/// Verifies a backup and copies it to `memory`. Error when `memory` exists, unless `replace` allows it; then
/// also while another program has it open.
BackupResult restore_memory(const std::filesystem::path& backup, const std::filesystem::path& memory,
                            Replace replace, Progress& progress);

}  // namespace loci::memory
