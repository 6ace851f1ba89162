#pragma once

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/fleet/fleet_database.h"

namespace loci::memory {

struct PushOptions {
  RobotName name = {};
  bool replace = false;  ///< the rows in the database go, whatever they are, even those of another memory
  std::string program = "loci-memory push";
  int64_t max_rows = 20000;  ///< of one transaction: little enough that a killed push loses a second of work
};

struct PushResult {
  std::map<std::string, int64_t> added = {};    ///< rows by table, changed ones included
  std::map<std::string, int64_t> removed = {};  ///< likewise: forgotten, discarded or changed
  int64_t transactions = 0;                     ///< 0 = the database had all of it

  int64_t added_rows() const;
  int64_t removed_rows() const;
  std::string summary() const;
  Json report() const;
};

/// Replicates a memory into a database. Every transaction stores rows together with the cursor that says how
/// far their table has come, so that a push that was killed at any moment is taken up by the next one, and
/// every row is there once. New rows are found by their key, rows that were changed or removed by the digest
/// of their table. A push of one transaction (up to 20,000 rows) is seen as a whole; while a longer one
/// lasts, readers keep the state before it.
class MemoryPush {
 public:
  /// Connects, makes the schema when it is missing, and keeps other pushes of this robot out.
  MemoryPush(std::filesystem::path memory, FleetUrl url, PushOptions options);

  /// Brings the database to the present state of the file. Can be repeated.
  PushResult run(Progress& progress);

 private:
  struct Cursor {
    std::optional<TableKey> key = {};
    int64_t rows = 0;
    uint64_t digest = 0;
  };
  struct Window;

  void claim(const TableReader& file);
  /// Error when the database honours tombstones that the file does not have: a push would undo them.
  void require_tombstones(const TableReader& file);
  /// Removes the rows of this memory.
  void clear();
  void read_cursors();
  /// Begins a transaction unless one is open.
  void begin();
  void commit(bool complete);
  /// Rows after the cursor.
  void append(const TableReader& file, const TableLayout& table, Progress& progress);
  /// Rows that differ anywhere.
  void reconcile(const TableReader& file, const TableLayout& table, Progress& progress);
  /// Replaces the rows of this memory by those that are staged.
  void apply_staged(const TableLayout& table);
  Window read_window(const TableLayout& table, const std::optional<TableKey>& after);
  /// A temporary table with the columns of `table` and "present".
  const std::string& staging(const TableLayout& table);
  void save_cursor(const TableLayout& table);
  SqlParameters name_parameters() const { return {options_.name.home, options_.name.robot}; }

  std::filesystem::path memory_;
  PushOptions options_;
  FleetDatabase database_;
  std::map<std::string, Cursor> cursors_;
  std::map<std::string, std::string> staging_;
  PushResult result_;
  int64_t total_rows_ = 0, done_rows_ = 0;  ///< of all tables, for the progress
  bool in_transaction_ = false;
  int64_t open_rows_ = 0;  ///< of the open transaction
};

}  // namespace loci::memory
