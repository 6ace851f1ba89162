#pragma once

// Private to this module: whether a file has the schema of its version. Before that is known nothing in it is
// run: triggers, views and indexes of a file are programs of whoever wrote it.

#include "memory/store/database.h"
#include "memory/store/format.h"
#include "memory/store/rows/table_rows.h"

namespace loci::memory {

/// Throws Error unless every object of the file's schema is that of `version`. A file of a newer minor
/// version needs only to have the tables of this program, as ordinary tables with at least their columns.
void check_schema(SQLite::Database& database, const std::filesystem::path& path, int version,
                  const MemoryFormat& format);

/// Of all objects of a schema: the same for a file whose schema was migrated to it.
std::string schema_digest(SQLite::Database& database);

/// Puts this program's views before those of a file of a newer minor version, which are never run.
void shadow_views(SQLite::Database& database, const MemoryFormat& format);

/// Whether this program's schema has such an object: type "table" or "view".
bool has_object(const MemoryFormat& format, const std::string& type, const std::string& name);

}  // namespace loci::memory
