#pragma once

// Private to this module: a digest of each table, by which Store::verify() notices rows that something else
// than this program changed, added or removed. It is kept while rows are added, in meta.digests.

#include "memory/store/database.h"

namespace loci::memory {

/// Of a row that is inserted. `id` counts where the table has a column of this name.
uint64_t row_digest(std::string_view table, const SqlColumns& columns, Id id);
/// Of the row at which a SELECT * stands.
uint64_t row_digest(std::string_view table, SQLite::Statement& row);

/// The stored digests by table; empty when a program wrote the memory that did not keep them yet.
std::map<std::string, uint64_t> stored_digests(SQLite::Database& database);
/// Tables whose rows follow from no others, but forgotten requests and meta: those that have a digest.
std::vector<std::string> digested_tables();
/// Computes the digests of all tables from their rows, and stores them.
void derive_digests(SQLite::Database& database);
/// Adds to the stored digests: the digest of a table is the sum of those of its rows, modulo 2^64.
void add_to_digests(Store::Connection& db, const std::map<std::string_view, uint64_t>& added);
/// Tables whose rows do not have the stored digest, one line each.
std::vector<std::string> digest_problems(Store::Connection& db);

}  // namespace loci::memory
