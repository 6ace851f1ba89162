#pragma once

// Private to this module: tables that follow from other tables, so that questions need not count or walk
// through a history. They are kept up to date while rows are added (Store::Connection) and can be derived
// again at any time.

#include "memory/store/database.h"

namespace loci::memory {

/// Which rows of association are observations of an object: the MAP hypothesis, unless it was taken back.
inline constexpr const char* kObserved = "chosen = 1 AND observation IS NOT NULL AND probability > 0";

/// Which rows of belief are known now.
inline constexpr const char* kKnownBelief =
    "known_to IS NULL AND NOT EXISTS (SELECT 1 FROM belief later WHERE later.supersedes = belief.id)";

/// `until` of a stay that has not ended.
inline constexpr int64_t kOpenStay = 2147483647;
/// The time of a stay, seconds since 1970 as far as 32 bits hold them (1901 to 2038), else the nearest that
/// they hold. Stays found by it are candidates: rows of belief have the exact times.
int64_t stay_seconds(TimeNs time);

/// Derives all of them.
void derive_tables(SQLite::Database& database);
/// Derives those of objects that have new observations, and stays of objects that have new beliefs, and adds
/// to the counts of rows; digests are left as they are.
void derive_tables_of(SQLite::Database& database, const std::set<Id>& observed, const std::set<Id>& believed,
                      std::map<std::string, int64_t> added);
/// Counts the rows of the large tables (row_count), and computes the digests of all tables.
void count_rows(SQLite::Database& database);
/// What does not follow from the other tables, one line each.
std::vector<std::string> derived_problems(Store::Connection& db);

}  // namespace loci::memory
